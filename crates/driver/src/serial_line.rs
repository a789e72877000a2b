//! A serial port as a line: one thread reads it, and the owner writes.

use std::{
    io::{ErrorKind, Write},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::Sender,
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use motorlink_bus::InFlight;
use motorlink_port::{Line, Written};
use motorlink_protocol::{Frame, Instant, family::Model};
use serialport::SerialPort;

use crate::{
    inputs::{Given, Input},
    latency::run_on_time,
};

/// How long a write may take: the buffer of the system has room for a frame, or the adapter is stalled.
const WRITE_MAX: Duration = Duration::from_millis(2);
/// How often the reader looks whether the port is being closed.
const READ_WAIT: Duration = Duration::from_millis(20);
/// Bytes of one read: more than arrive in that time at 115,200 baud.
const BUFFER: usize = 4096;

/// An open serial port.
pub(crate) struct SerialLine {
    port: Box<dyn SerialPort>,
    in_flight: InFlight,
    is_closing: Arc<AtomicBool>,
    reader: Option<JoinHandle<()>>,
}

impl SerialLine {
    /// Opens the port for this model, 8N1, and starts to read it. Its bytes go to `inputs` with this number.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn open(
        path: &str,
        model: Model,
        number: u32,
        inputs: Sender<Given>,
    ) -> serialport::Result<Self> {
        let builder = serialport::new(path, model.spec().baud);
        let port = builder.timeout(WRITE_MAX).open()?;
        let mut reading = port.try_clone()?;
        reading.set_timeout(READ_WAIT)?;
        let is_closing = Arc::new(AtomicBool::new(false));
        let closing = Arc::clone(&is_closing);
        let name = "motorlink reader".to_owned();
        let read = move || read(reading.as_mut(), number, &inputs, &closing);
        let reader = thread::Builder::new().name(name).spawn(read)?;
        Ok(Self {
            port,
            in_flight: InFlight::default(),
            is_closing,
            reader: Some(reader),
        })
    }
}

impl Drop for SerialLine {
    /// Closes the port. The reader lets go of it within [`READ_WAIT`].
    fn drop(&mut self) {
        self.is_closing.store(true, Ordering::Relaxed);
        if let Some(reader) = self.reader.take() {
            // It does not panic, and if it did, it would have let go of the port.
            let _ = reader.join();
        }
    }
}

impl Line for SerialLine {
    fn write(&mut self, now: Instant, model: Model, frame: &Frame) -> Written {
        if !self.in_flight.admits(now, model, frame) {
            return Written::Refused;
        }
        match self.port.write_all(frame.bytes()) {
            Ok(()) => {
                self.in_flight.handed_over(now, model, frame);
                Written::Taken
            }
            Err(error) if is_busy(error.kind()) => Written::Refused,
            Err(_) => Written::Gone,
        }
    }

    fn has_received(&mut self) {
        self.in_flight.received();
    }
}

/// Whether the port is there and only takes or has nothing now.
fn is_busy(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::TimedOut | ErrorKind::Interrupted | ErrorKind::WouldBlock
    )
}

/// Reads the port until it is closed or gone.
fn read(port: &mut dyn SerialPort, number: u32, inputs: &Sender<Given>, closing: &AtomicBool) {
    run_on_time();
    let mut buffer = [0; BUFFER];
    while !closing.load(Ordering::Relaxed) {
        let input = match port.read(&mut buffer) {
            Ok(0) => Input::PortGone(number),
            Ok(count) => Input::Bytes(number, buffer.get(..count).unwrap_or_default().to_vec()),
            Err(error) if is_busy(error.kind()) => continue,
            Err(_) => Input::PortGone(number),
        };
        let ends = matches!(input, Input::PortGone(_));
        if inputs.send(input.into()).is_err() || ends {
            return;
        }
    }
}
