// A function of a program in C# that throws where palpate calls it: the exception arrives after the call, once, and the
// session can still be used and closed.
using System;

static class Throwing {
  static int Main() {
    ulong session = Press.Opened();
    Palpate.ContactFunction heard =
        Palpate.Guarded(happened => { throw new InvalidOperationException("a fault of the program"); });
    Palpate.Expect(Palpate.pp_session_on_contact(session, heard, IntPtr.Zero));
    var contact = new Palpate.Contact();
    int thrown = 0;
    for (int tick = 0; tick < 200; ++tick) {
      var pose = new Palpate.Pose { t_s = 1e-3 * tick, z = tick < 100 ? 51 - 0.02 * tick : 49 };
      int status = Palpate.pp_touch(session, ref pose, out contact);
      try {
        Palpate.Expect(status);
      } catch (Exception error) {
        if (status == 0 && error.InnerException is InvalidOperationException) ++thrown;
      }
    }
    Palpate.Expect(Palpate.pp_session_close(session));
    GC.KeepAlive(heard);
    if (thrown == 1 && contact.contact == 1 && contact.valid == 1) return 0;
    Console.WriteLine("{0} exceptions arrived; contact {1}, valid {2}", thrown, contact.contact, contact.valid);
    return 1;
  }
}
