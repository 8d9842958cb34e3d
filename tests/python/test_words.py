"""A misspelt name, or an argument of the wrong kind, gives an error that helps."""

from __future__ import annotations

import numpy as np
import palpate as pp
import pytest
from conftest import ball_arrays, press_path


@pytest.mark.parametrize("call, told", [
    (lambda s: pp.Session(s.cloud(), radious_mm=3), "Session(): there is no argument 'radious_mm'; did you mean "
     "radius_mm? It takes cloud, gpu, mm_per_unit, backend, surface, radius_mm, friction, "),
    (lambda s: pp.Cloud([[1, 2, 3]], colours=[[1, 2, 3]]), "Cloud(): there is no argument 'colours'; did you mean "
     "colors? It takes xyz, normals, colors"),
    (lambda s: s.touch(press_path(1), surfaec="sharp"), "touch(): there is no argument 'surfaec'; did you mean "
     "surface? It takes path, surface"),
    (lambda s: s.push(press_path(1), radiusmm=3),
     "push(): there is no argument 'radiusmm'; did you mean radius_mm?"),
    (lambda s: s.push(press_path(1), strenght=1), "push(): there is no argument 'strenght'; did you mean strength?"),
    (lambda s: s.set_brush("push", radis=3), "set_brush(): there is no argument 'radis'; did you mean radius?"),
    (lambda s: s.stroke(press_path(1), "push", zzz=3), "stroke(): there is no argument 'zzz'; it takes path, kind, "
     "radius_mm, yield_depth_mm, radius, yield_depth, push_rate, strength, falloff, resample, accumulate, color"),
    (lambda s: s.live(rat=3), "live(): there is no argument 'rat'; did you mean rate?"),
    (lambda s: s.render(siz=(9, 9)), "render(): there is no argument 'siz'; did you mean size?"),
    (lambda s: s.mesh(resoluton=9), "mesh(): there is no argument 'resoluton'; did you mean resolution?"),
    (lambda s: pp.Matter("dam", gpus="cpu"), "Matter(): there is no argument 'gpus'; did you mean gpu?"),
    (lambda s: pp.read("x.ply", keep_unrelable=True),
     "read(): there is no argument 'keep_unrelable'; did you mean keep_unreliable?"),
    (lambda s: pp.write("x.ply", s.cloud(), asci=True),
     "write(): there is no argument 'asci'; did you mean ascii?"),
    (lambda s: pp.replay("x", tolerence=1), "replay(): there is no argument 'tolerence'; did you mean tolerance?"),
    (lambda s: pp.serve(s.cloud(), nam="x"), "serve(): there is no argument 'nam'; did you mean name?"),
    (lambda s: pp.discover(second=1), "discover(): there is no argument 'second'; did you mean seconds?"),
    (lambda s: pp.Session.join("x", timeot_s=1),
     "Session.join(): there is no argument 'timeot_s'; did you mean timeout_s?"),
    (lambda s: pp.Session.of_scene("water", hand=2), "Session.of_scene(): there is no argument 'hand'; did you mean "
     "hands? It takes scene, gpu, mm_per_unit, backend, surface, "),
    (lambda s: pp.Session.of_frames(s.cloud(), max_point=9),
     "Session.of_frames(): there is no argument 'max_point'; did you mean max_points?"),
    (lambda s: pp.Network(interfce="lo"), "Network(): there is no argument 'interfce'; did you mean interface?"),
    (lambda s: pp.Hand(devise="sim"), "Hand(): there is no argument 'devise'; did you mean device?"),
    (lambda s: s.touch(), "touch(): path is missing; it takes path, surface"),
    (lambda s: pp.Session(), "Session(): cloud is missing; it takes cloud, gpu, "),
    (lambda s: s.touch(press_path(1), "sharp", 3),
     "touch(): takes 2 arguments, and 3 are given; it takes path, surface"),
    (lambda s: pp.Session(s.cloud(), "cpu", 1, "sharp"), "Session(): takes 3 arguments by position, the others by "
     "name, and 4 are given; it takes cloud, gpu, mm_per_unit, backend, surface, "),
    (lambda s: s.touch(press_path(1), path=3), "touch(): path is given twice"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", radius_mm="a"),
     "Session(): radius_mm must be a number or None, not the text 'a'"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", threads=-1),
     "Session(): threads must be a whole number of 0 or more, not -1"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", tool_axis=(1, 2)),
     "Session(): tool_axis must be three numbers, not (1, 2)"),
    (lambda s: pp.Session.of_stream("x", gpu="cpu", loop="yes"),
     "Session.of_stream(): loop must be True or False, not the text 'yes'"),
    (lambda s: pp.Session(s.cloud(), backend="gpu"),
     "backend: unknown value 'gpu'; did you mean 'cpu'? Choose auto, vulkan, cpu"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", backend="vulkan"), "backend: vulkan conflicts with gpu 'cpu'"),
    (lambda s: pp.Session(s.cloud(), gpu=0, backend="cpu"), "backend: cpu conflicts with gpu '0'"),
    (lambda s: s.push(press_path(1), yield_depth_mm="a"), "yield_depth_mm: must be a number, not the text 'a'"),
    (lambda s: s.push(press_path(1), color=(1, 2, 300)), "color: must be three whole numbers from 0 to 255, not "
     "(1, 2, 300)"),
    (lambda s: s.undo("one"), "undo(): strokes must be a whole number, not the text 'one'"),
    (lambda s: s.undo(1.5), "undo(): strokes must be a whole number, not 1.5"),
    (lambda s: s.undo(-1), "undo(): strokes must be a whole number of 0 or more, not -1"),
    (lambda s: s.render("large"), "render(): size must be two whole numbers, not the text 'large'"),
    (lambda s: s.render((9, 9), eye=(1, 2)), "render(): eye must be three numbers or None, not (1, 2)"),
    (lambda s: s.live(on_ticks=3, builtin="press"), "on_ticks: must be a function, not 3"),
    (lambda s: s.live(others=[3], builtin="press"), "others: must be a list of Hand, but contains 3"),
    (lambda s: s.live(3), "device must be a text or None, not 3"),
    (lambda s: s.live("sim"), "device: sim requires the path of the hand: give builtin=press, slide, scan or "
     "orbit"),
    (lambda s: s.live(), "device: path requires the path of the hand: give builtin=press, slide, scan or "
     "orbit, or a path"),
    (lambda s: pp.Matter(3), "Matter(): scene must be a text, not 3"),
    (lambda s: pp.read(3), "file: must be a path, not 3"),
    (lambda s: pp.write("x.ply", [1]), "write(): cloud must be a Cloud, not [1]"),
    (lambda s: pp.Session(3), "Session(): cloud must be a Cloud, not 3"),
    (lambda s: pp.Session("water"), "Session(): cloud must be a Cloud, not the text 'water'"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", law=3), "law: 3 is not the address of a function"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", surface="shrp"),
     "surface: unknown value 'shrp'; did you mean 'sharp'? Choose average, sphere, sharp"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", tool="x"), "tool: unknown value 'x'; choose point, pad, ball, "
     "spatula"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", mm_per_unit=-1), "mm_per_unit: -1 is not between"),
    (lambda s: s.push(press_path(1), radius_mm=-3), "radius_mm: -3 is not between"),
    (lambda s: s.set_contact(stiffness_N_per_mm=1e9), "stiffness_N_per_mm: "),
    (lambda s: s.set_contact(max_force_N=-1), "max_force_N: "),
    (lambda s: pp.discover(5), "network: must be a Network, not 5"),
    (lambda s: pp.Session.of_clouds(s.cloud()), "clouds: must be a list of Cloud, not a Cloud"),
    (lambda s: pp.Session(s.cloud(), gpu="cpu", threads=1 << 70), "Session(): threads is too large"),
    (lambda s: pp.Cloud(np.zeros((5, 3), "M8[s]")), "xyz: must be real numbers, not of the type datetime64[s]"),
])
def test_a_call_that_does_not_fit_says_what_was_meant(session, call, told):
    with pytest.raises(pp.UsageError) as caught:
        call(session)
    assert str(caught.value).startswith(told)


@pytest.mark.skipif(not pp.can_simulate(), reason="this palpate was built without PALPATE_SIMULATION")
@pytest.mark.parametrize("call, told", [
    (lambda m: m.simulate("a"), "simulate(): seconds must be a number, not the text 'a'"),
    (lambda m: pp.Matter("dam", gpu=0, backend="cpu"), "backend: cpu conflicts with gpu '0'"),
    (lambda m: m.set("gain", "a"), "set(): value must be a number, not the text 'a'"),
])
def test_a_call_of_matter_that_does_not_fit_says_what_was_meant(dam, call, told):
    with pytest.raises(pp.UsageError) as caught:
        call(dam)
    assert str(caught.value).startswith(told)


@pytest.fixture(scope="module")
def session():
    xyz, normals = ball_arrays(5000)
    with pp.Session(pp.Cloud(xyz, normals=normals), gpu="cpu", mm_per_unit=1) as opened:
        yield opened


@pytest.fixture(scope="module")
def dam():
    with pp.Matter("dam", gpu="cpu") as scene:
        yield scene


@pytest.mark.parametrize("kind, builtin, status, call", [
    (pp.UsageError, ValueError, "argument", lambda s: s.mesh(resolution=0)),
    (pp.ArgumentTypeError, TypeError, "argument", lambda s: s.undo("one")),
    (pp.UnknownNameError, KeyError, "argument", lambda s: s.cloud().attribute("rain")),
    (pp.UnknownAttributeError, AttributeError, "argument", lambda s: s.pionts),
    (pp.ClosedError, AttributeError, "handle", lambda s: (s.close(), s.touch(press_path(1)))),
    (pp.Error, RuntimeError, "file", lambda s: pp.read("nowhere.ply")),
    (pp.Error, RuntimeError, "state", lambda s: s.pause()),
])
def test_each_error_is_of_its_class_of_pythons_own_and_has_its_status(ball, kind, builtin, status, call):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as s:
        with pytest.raises(pp.Error) as caught:
            call(s)
    assert type(caught.value) is kind and isinstance(caught.value, builtin)
    assert caught.value.status == status


def test_unknown_keywords_are_type_errors_too_and_a_programs_own_type_errors_stay(session):
    with pytest.raises(TypeError) as caught:
        session.touch(press_path(1), surfaec="sharp")
    assert isinstance(caught.value, pp.ArgumentTypeError)

    class Path:
        def __fspath__(self) -> str:
            raise TypeError("of this program")

    with pytest.raises(TypeError) as own:
        pp.read_recording(Path())
    assert "of this program" in str(own.value) or "file: must be a path" in str(own.value)


@pytest.mark.parametrize("row, column, value, told", [
    (7, 1, np.nan, "path: pose 7 of 200, counted from 0: y is nan; expected a finite number"),
    (0, 2, np.inf, "path: pose 0 of 200, counted from 0: z is inf; expected a finite number")])
def test_a_pose_that_is_no_number_is_named_by_its_row_and_column(session, row, column, value, told):
    path = press_path(1)
    path[row, column] = value
    with pytest.raises(pp.UsageError) as caught:
        session.touch(path)
    assert str(caught.value) == told


def test_rows_are_counted_from_0_in_every_array(session):
    timed = np.column_stack([np.arange(200) / 1000, press_path(1)])
    timed[9, 0] = np.nan
    with pytest.raises(pp.UsageError, match="pose 9 of 200, counted from 0: the time is nan"):
        session.touch(timed)
    timed[9, 0] = 0
    with pytest.raises(pp.UsageError, match="pose 9 of 200, counted from 0: its time is 0 s, and that of the pose "
                       "before it 0.008 s; times have to increase"):
        session.touch(timed)
    xyz, normals = ball_arrays(100)
    xyz[5, 2] = np.nan
    with pytest.raises(pp.UsageError, match="^row 5 of 100, counted from 0: z is nan; expected finite numbers below "
                       "1e30$"):
        pp.Cloud(xyz)
    normals[6, 0] = np.inf
    with pytest.raises(pp.UsageError, match="^row 6 of 100, counted from 0: nx is inf; expected finite numbers$"):
        pp.Cloud(ball_arrays(100)[0], normals=normals)


@pytest.mark.parametrize("kind", [np.int64, np.int32, np.int16, np.int8, np.uint32, np.uint64])
def test_whole_numbers_of_any_type_are_colours_where_all_are_bytes(kind):
    xyz, _ = ball_arrays(50)
    bytes_ = (np.arange(150).reshape(50, 3) % 128).astype(np.uint8)
    assert np.array_equal(pp.Cloud(xyz, colors=bytes_.astype(kind)).colors, pp.Cloud(xyz, colors=bytes_).colors)
    wrong = bytes_.astype(kind)
    value = -1 if kind == np.int8 else 256
    wrong[4, 2] = value
    with pytest.raises(pp.UsageError, match=f"colors: row 4: blue is {value}; whole numbers are 0 to 255"):
        pp.Cloud(xyz, colors=wrong)


def test_colours_of_another_shape_or_kind_say_what_is_wrong():
    xyz, _ = ball_arrays(50)
    with pytest.raises(pp.UsageError, match=r"colors: has shape \(3, 3\), not \(50, 3\)"):
        pp.Cloud(xyz, colors=np.zeros((3, 3), np.int64))
    with pytest.raises(pp.UsageError, match="colors: must be whole numbers .* or floats .*, not bool"):
        pp.Cloud(xyz, colors=np.zeros((50, 3), bool))


def test_what_is_closed_says_so(ball):
    s = pp.Session(ball, gpu="cpu")
    s.close()
    for call in (lambda: s.touch(press_path(1)), lambda: s.points, lambda: s.live(), lambda: s.cloud()):
        with pytest.raises(pp.ClosedError, match="^the session is closed$"):
            call()
    assert repr(s) == "<palpate.Session: the session is closed>"


def test_a_limit_that_cannot_be_read_says_where_it_is_given_and_a_slip_what_was_meant(session):
    for thing, name, told in (
            (session, "max_force_N", "max_force_N: cannot be read; is set when the Session is created: "
             "Session(max_force_N=…)"),
            (session, "pionts", "pionts: a Session has no such attribute; did you mean points?"),
            (session.cloud(), "colour", "colour: a Cloud has no such attribute; did you mean colors?"),
            (pp, "tick_dtyp", "module 'palpate' has no attribute 'tick_dtyp'; did you mean tick_dtype?")):
        with pytest.raises(AttributeError) as caught:
            getattr(thing, name)
        assert str(caught.value) == told
        assert not hasattr(thing, name)
    with pytest.raises(pp.UnknownAttributeError, match="frction: cannot be set on a Session; did you mean friction?"):
        session.frction = 0.1
    with pytest.raises(pp.UnknownAttributeError, match="points: cannot be set on a Session, only read"):
        session.points = 3


def test_the_module_lists_what_it_offers_and_nothing_else():
    assert sorted(dir(pp)) == sorted([*pp.__all__, "__version__"])
    for name in dir(pp):
        assert getattr(pp, name) is not None


def test_messages_have_no_names_of_c(session):
    for call in (session.pause, session.reset, session.frame, session.settle, lambda: session.set("gain", 3),
                 lambda: session.add_frame(0, *ball_arrays(10))):
        with pytest.raises(pp.Error) as caught:
            call()
        assert "pp_" not in str(caught.value) and str(caught.value).startswith(("the points of this", "this session"))
