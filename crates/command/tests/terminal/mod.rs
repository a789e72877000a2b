//! The command on a terminal of its own.

use std::{
    fs::File,
    io::{Read, Write},
    os::unix::ffi::OsStrExt,
    process::{Child, Command, ExitStatus, Stdio},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle, sleep},
    time::{Duration, Instant},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    fs::{Mode, OFlags, open},
    pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    termios::{Winsize, tcsetwinsize},
};

/// A busy machine is slow.
const PATIENCE: Duration = Duration::from_secs(20);

/// A program on a terminal of 100 columns.
pub struct Terminal {
    pub child: Child,
    keys: File,
    shown: Arc<Mutex<String>>,
    /// What was expected so far ends here.
    read: usize,
    reader: JoinHandle<()>,
    is_closed: Arc<AtomicBool>,
}

impl Terminal {
    pub fn run(mut command: Command) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        // The program must not hold its own terminal open.
        rustix::io::fcntl_setfd(&master, rustix::io::FdFlags::CLOEXEC).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let name = ptsname(&master, Vec::new()).unwrap();
        let path = std::path::Path::new(std::ffi::OsStr::from_bytes(name.to_bytes()));
        let slave = open(path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
        let size = Winsize {
            ws_row: 24,
            ws_col: 100,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        tcsetwinsize(&slave, size).unwrap();
        let [input, output, error] = [0, 1, 2].map(|_| Stdio::from(slave.try_clone().unwrap()));
        let child = command.stdin(input).stdout(output).stderr(error);
        let child = child.spawn().unwrap();
        let keys = File::from(master);
        let mut screen = keys.try_clone().unwrap();
        let shown = Arc::<Mutex<String>>::default();
        let to_show = Arc::clone(&shown);
        // A terminal that nobody reads blocks the program. It ends with an error when the program has closed its end.
        let is_closed = Arc::<AtomicBool>::default();
        let closed = Arc::clone(&is_closed);
        let reader = thread::spawn(move || {
            let mut piece = [0; 4096];
            while !closed.load(Ordering::Relaxed) {
                let wait = Timespec::try_from(Duration::from_millis(20)).unwrap();
                if poll(&mut [PollFd::new(&screen, PollFlags::IN)], Some(&wait)).unwrap() == 0 {
                    continue;
                }
                let Ok(count @ 1..) = screen.read(&mut piece) else {
                    break;
                };
                let text = String::from_utf8_lossy(&piece[..count]);
                to_show.lock().unwrap().push_str(&text);
            }
        });
        Self {
            child,
            keys,
            shown,
            read: 0,
            reader,
            is_closed,
        }
    }

    /// Closes the window of the terminal. Returns how the program has ended; `None` if it still runs after this time.
    pub fn hang_up(mut self, within: Duration) -> Option<ExitStatus> {
        self.is_closed.store(true, Ordering::Relaxed);
        self.reader.join().unwrap();
        drop(self.keys);
        let until = Instant::now() + within;
        while Instant::now() < until {
            if let Some(status) = self.child.try_wait().unwrap() {
                return Some(status);
            }
            sleep(Duration::from_millis(20));
        }
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        None
    }

    pub fn press(&mut self, keys: &str) {
        self.keys.write_all(keys.as_bytes()).unwrap();
    }

    /// All that was shown so far, with the codes of the terminal.
    pub fn shown(&self) -> String {
        self.shown.lock().unwrap().clone()
    }

    /// Waits until this is shown behind what was expected before. Of a full screen, only what has changed is shown: words
    /// come without the spaces between them.
    pub fn expect(&mut self, text: &str) {
        let until = Instant::now() + PATIENCE;
        loop {
            let shown = self.shown();
            let new = &shown[self.read..];
            if let Some(at) = new.find(text) {
                self.read += at + text.len();
                return;
            }
            let last = new.len().saturating_sub(2_000);
            let last = String::from_utf8_lossy(&new.as_bytes()[last..]);
            assert!(Instant::now() < until, "{text:?} is not shown: {last}");
            sleep(Duration::from_millis(20));
        }
    }

    /// Waits for a question, and answers it.
    pub fn answer(&mut self, question: &str, answer: &str) {
        self.expect(question);
        self.press(&format!("{answer}\n"));
    }

    /// Waits for the end. Returns the exit code, and all that was shown.
    pub fn end(mut self) -> (Option<i32>, String) {
        let code = self.child.wait().unwrap().code();
        self.reader.join().unwrap();
        let shown = self.shown.lock().unwrap().clone();
        (code, shown)
    }
}
