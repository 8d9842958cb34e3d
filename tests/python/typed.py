"""A typed program for mypy; it is not run."""

from __future__ import annotations

import numpy as np
import palpate as pp
from numpy.typing import NDArray


def strongest(file: str) -> float:
    cloud: pp.Cloud = pp.read(file)
    with pp.Session(cloud, gpu="cpu", surface="sharp") as session:
        ticks: NDArray[np.void] = session.touch(np.zeros((10, 3)))
        picture: NDArray[np.uint8] = session.render((320, 200), eye=(1.0, 2.0, 3.0))
        print(picture.shape, session.mesh(resolution=64).triangles.shape, pp.tick_dtype.names)
        with session.live(builtin="press", on_ticks=lambda block: print(len(block))) as live:
            live.wait(1)
        pp.write("out.ply", session.cloud())
    return float(ticks["penetration_mm"].max())


def stirred(scene: str) -> float:
    with pp.Matter(scene, gpu="cpu") as matter:
        matter.simulate(0.1)
        velocities: NDArray[np.float32] = matter.frame().velocities
        print(matter.state()["front_mm"], matter.parameters["gain"].high)
    with pp.Session.of_scene(scene, hands=2, law=lambda tick: tick.force_N, allow_python_law=True) as water:
        ticks: NDArray[np.void] = water.touch([np.zeros((10, 3)), np.zeros((10, 3))])
        with water.live(builtin="press", others=[pp.Hand(builtin="orbit")]) as live:
            water.set("gain", 2)
            print(live.late_laws, water.port_energies[0].min_J, water.failure)
    return float(velocities.max()) + float(ticks["t_s"].max())


def filmed(cloud: pp.Cloud) -> float:
    with pp.Session.of_frames(cloud, stable_rows=True) as film:
        film.add_frame(0.5, np.zeros((10, 3)), np.ones((10, 3)))
        return film.frame().t_s


def recorded(file: str, log: str) -> bool:
    with pp.Session(pp.read(file)) as session:
        session.record(log)
        session.touch(np.zeros((10, 3)))
    read: pp.Recording = pp.read_recording(log)
    forces: NDArray[np.float64] = read.ticks["force_N"]
    print(forces.max(), read.header["machine"], read.missing, read.map[0])
    return pp.replay(log, gpu="cpu").identical


def shared(cloud: pp.Cloud) -> float:
    network = pp.Network(domain=3)
    seen: list[pp.SessionInfo] = pp.discover(network, seconds=0.5)
    server = pp.serve(cloud, "mine", network, read_only=True)
    with server, pp.Session.join("mine", network, partial=True) as session:
        sharing: pp.Sharing | None = session.sharing
        places: list[tuple[float, float, float]] = [hand.position for hand in session.other_hands]
        session.publish_camera(places[0] if places else (0.0, 0.0, 1.0), (1, 0, 0, 0), aspect=1.5)
        angles: list[float] = [camera.fov_deg for camera in session.cameras]
        print(seen, places, angles, session.settle(1), server.wait(0.1), server.cloud().positions.shape)
        return (sharing and sharing.round_trip_ms) or 0.0


def looped(cloud: pp.Cloud) -> float:
    poses = [None, pp.Pose(position=(1, 2, 3))]
    with pp.Session.of_clouds([cloud, cloud], poses=poses, budget_us=500, on_message=print) as session:
        session.on_contact(lambda event: print(event.begins, event.hand, event.proxy))
        contact: pp.Contact = session.touch_pose(0.0, (0, 0, 1))
        both: list[pp.Contact] = session.touch_poses(0.001, np.zeros((2, 3)))
        hits: NDArray[np.void] = session.raycast(np.zeros((4, 3)), np.ones((4, 3)))
        print(contact.validity == "held", both[0].age_s, session.nearest([[0, 0, 0]]), session.rows()["changed"].any())
        session.on_contact(None)
        session.lift()
    return float(hits["distance"].max())


def failing() -> int | None:
    try:
        pp.read("nowhere.ply")
    except pp.UsageError:
        return None
    except pp.Error as error:
        return error.line
    return 0
