// A ball of 20,000 points of 50 mm, and a hand that presses 1 mm into it: palpate called as from Unity, by P/Invoke.
using System;
using System.Runtime.InteropServices;
using System.Threading;

static class Palpate {
  const string Library = "palpate";

  [StructLayout(LayoutKind.Sequential)]
  public struct Rows {
    public IntPtr data;
    public int type, reserved;
    public long stride;
  }
  [StructLayout(LayoutKind.Sequential)]
  public struct CloudArrays {
    public uint size, reserved;
    public ulong count;
    public Rows positions, normals, colors;
  }
  [StructLayout(LayoutKind.Sequential)]
  public struct SessionOptions {
    public uint size, threads;
    public IntPtr gpu;
    public double mm_per_unit;
    public uint estimate_normals, reserved;
    public double rate_Hz;
    public IntPtr contact;
    public double budget_us, undo_memory_MiB;
    public IntPtr law, law_user, law_library, log, log_user;
  }
  [StructLayout(LayoutKind.Sequential)]
  public struct Pose {
    public double t_s, x, y, z;
    public uint no_edit, reserved;
  }
  [StructLayout(LayoutKind.Sequential)]
  public struct Contact {
    public double proxy_x, proxy_y, proxy_z, normal_x, normal_y, normal_z, force_x, force_y, force_z, penetration_mm;
    public uint neighbours;
    public byte contact, fresh, valid, withheld;
    public double age_s;
  }

  [StructLayout(LayoutKind.Sequential)]
  public struct ContactEvent {
    public double t_s, proxy_x, proxy_y, proxy_z, normal_x, normal_y, normal_z, force_x, force_y, force_z;
    public uint hand, begins;
  }
  [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
  public delegate void ContactFunction(IntPtr user, ref ContactEvent happened);

  [DllImport(Library)] public static extern IntPtr pp_version();
  [DllImport(Library)] public static extern IntPtr pp_last_error();
  [DllImport(Library)] public static extern void pp_init_cloud_arrays(out CloudArrays arrays, uint size);
  [DllImport(Library)] public static extern void pp_init_session_options(out SessionOptions options, uint size);
  [DllImport(Library)] public static extern int pp_cloud_create(ref CloudArrays arrays, out ulong cloud);
  [DllImport(Library)] public static extern int pp_cloud_close(ulong cloud);
  [DllImport(Library)]
  public static extern int pp_session_open(ulong cloud, ref SessionOptions options, out ulong session);
  [DllImport(Library)] public static extern int pp_session_close(ulong session);
  [DllImport(Library)] public static extern int pp_touch(ulong session, ref Pose pose, out Contact contact);

  [DllImport(Library)]
  public static extern int pp_session_on_contact(ulong session, ContactFunction function, IntPtr user);

  static Exception raised;

  // No exception may leave a function that palpate calls: it would skip palpate's own frames, which release the
  // session. The first one is kept until the call has returned, and Expect() throws it. The program keeps a reference
  // to the function that this returns while palpate may call it.
  public static ContactFunction Guarded(Action<ContactEvent> act) {
    return delegate (IntPtr user, ref ContactEvent happened) {
      try {
        act(happened);
      } catch (Exception error) {
        Interlocked.CompareExchange(ref raised, error, null);
      }
    };
  }

  public static void Expect(int status) {
    Exception error = Interlocked.Exchange(ref raised, null);
    if (error != null) throw new Exception("a function that palpate called: " + error.Message, error);
    if (status != 0) throw new Exception(Marshal.PtrToStringAnsi(pp_last_error()));
  }
}

static class Press {
  const int Points = 20000;

  public static ulong Opened() {
    var positions = new float[3 * Points];
    var normals = new float[3 * Points];
    for (int i = 0; i < Points; ++i) {
      double z = 1 - (2.0 * i + 1) / Points, r = Math.Sqrt(1 - z * z), turn = 2 * Math.PI * i / 1.618033988749895;
      double[] normal = { r * Math.Cos(turn), r * Math.Sin(turn), z };
      for (int k = 0; k < 3; ++k) {
        normals[3 * i + k] = (float)normal[k];
        positions[3 * i + k] = (float)(50 * normal[k]);
      }
    }
    GCHandle places = GCHandle.Alloc(positions, GCHandleType.Pinned);
    GCHandle facing = GCHandle.Alloc(normals, GCHandleType.Pinned);
    Palpate.CloudArrays arrays;
    Palpate.pp_init_cloud_arrays(out arrays, (uint)Marshal.SizeOf(typeof(Palpate.CloudArrays)));
    arrays.count = Points;
    arrays.positions.data = places.AddrOfPinnedObject();
    arrays.normals.data = facing.AddrOfPinnedObject();
    ulong cloud, session;
    Palpate.Expect(Palpate.pp_cloud_create(ref arrays, out cloud));
    places.Free();
    facing.Free();

    Palpate.SessionOptions options;
    Palpate.pp_init_session_options(out options, (uint)Marshal.SizeOf(typeof(Palpate.SessionOptions)));
    options.gpu = Marshal.StringToHGlobalAnsi("cpu");
    options.mm_per_unit = 1;
    Palpate.Expect(Palpate.pp_session_open(cloud, ref options, out session));
    Marshal.FreeHGlobal(options.gpu);
    Palpate.Expect(Palpate.pp_cloud_close(cloud));
    return session;
  }

  static void Main() {
    ulong session = Opened();
    double began_s = -1;
    Palpate.ContactFunction heard = Palpate.Guarded(happened => began_s = happened.t_s);
    Palpate.Expect(Palpate.pp_session_on_contact(session, heard, IntPtr.Zero));
    var contact = new Palpate.Contact();
    for (int tick = 0; tick < 200; ++tick) {
      var pose = new Palpate.Pose { t_s = 1e-3 * tick, z = tick < 100 ? 51 - 0.02 * tick : 49 };
      Palpate.Expect(Palpate.pp_touch(session, ref pose, out contact));
    }
    Palpate.Expect(Palpate.pp_session_close(session));
    GC.KeepAlive(heard);
    Console.WriteLine(string.Format(System.Globalization.CultureInfo.InvariantCulture,
                                    "{0}: {1:F3} N at {2:F3} mm, touched at {3:F3} s",
                                    Marshal.PtrToStringAnsi(Palpate.pp_version()), contact.force_z,
                                    contact.penetration_mm, began_s));
  }
}
