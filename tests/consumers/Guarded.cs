// A guarded function throws: Expect() says so, and the session goes on. Built with Press.cs, of which it is a test.
using System;

static class GuardedTest {
  static void Main() {
    ulong session = Press.Open();
    int calls = 0;
    Palpate.ContactFunction heard = Palpate.Guarded(change => {
      ++calls;
      throw new InvalidOperationException("no room for a contact");
    });
    Palpate.Expect(Palpate.pp_session_on_contact(session, heard, IntPtr.Zero));
    string said = "nothing";
    try {
      Press.Down(session);
    } catch (Exception exception) {
      said = exception.Message + ": " + (exception.InnerException == null ? "" : exception.InnerException.Message);
    }
    if (said != "a function that palpate called has failed: no room for a contact")
      throw new Exception("an exception of a guarded function was reported as: " + said);
    Palpate.Expect(Palpate.pp_session_on_contact(session, null, IntPtr.Zero));
    Palpate.Contact contact = Press.Down(session, 1);
    if (calls == 0 || contact.contact == 0 || contact.force_z <= 0)
      throw new Exception("the session did not go on after an exception of a guarded function");
    Palpate.Expect(Palpate.pp_session_close(session));
    GC.KeepAlive(heard);
    Console.WriteLine("guarded: exceptions: " + calls + ", and the session goes on");
  }
}
