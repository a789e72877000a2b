//! The simulated computer, as the driver has it.

use std::{cell::RefCell, io, panic::resume_unwind, rc::Rc, time::Duration};

use motorlink_bus::InFlight;
use motorlink_driver::{
    ChosenPort, Computer, DrivenFile, Input, Line, NoFile, OpenFailure, Store, Told, Written,
};
use motorlink_protocol::{Frame, Instant, family::Model};

use super::machine::Machine;

/// How long a write to a stalled port takes before it is given up.
const WRITE_TAKES: Duration = Duration::from_millis(2);

/// A handle on the machine.
pub(super) struct SimulatedComputer(pub(super) Rc<RefCell<Machine>>);

impl Computer for SimulatedComputer {
    fn now(&mut self) -> Instant {
        self.0.borrow().time_of_driver()
    }

    fn wait(&mut self, until: Instant) -> Option<(Input, Duration)> {
        self.0.borrow_mut().wait(until)
    }

    fn tell(&mut self, told: Told) {
        self.0.borrow_mut().told(told);
    }

    fn opened(&mut self, result: Result<Model, OpenFailure>) {
        self.0.borrow_mut().opened(result.ok());
    }

    fn find_port(&mut self, _path: Option<&str>) -> Result<ChosenPort, OpenFailure> {
        let path = self.0.borrow().port.path();
        let path = path.ok_or(OpenFailure::NoPort)?;
        Ok(ChosenPort { path, usb: None })
    }

    fn port_again(&mut self, _port: &ChosenPort) -> Option<String> {
        self.0.borrow().port.path()
    }

    fn open_line(
        &mut self,
        path: &str,
        model: Model,
        number: u32,
    ) -> Result<Box<dyn Line>, OpenFailure> {
        self.0.borrow_mut().open(path, model, number)?;
        Ok(Box::new(SimulatedLine {
            machine: Rc::clone(&self.0),
            unplugged: self.0.borrow().port.unplugged,
            in_flight: InFlight::default(),
        }))
    }

    fn open_file(&mut self, _adapter: &str) -> Result<DrivenFile, NoFile> {
        let store = SimulatedStore(Rc::clone(&self.0));
        Ok(DrivenFile::new(Box::new(store), self.0.borrow().file()))
    }
}

/// An open line.
struct SimulatedLine {
    machine: Rc<RefCell<Machine>>,
    unplugged: u32,
    in_flight: InFlight,
}

impl Line for SimulatedLine {
    fn write(&mut self, now: Instant, model: Model, frame: &Frame) -> Written {
        let mut machine = self.machine.borrow_mut();
        if machine.is_over() || machine.port.unplugged != self.unplugged {
            return Written::Gone;
        }
        if machine.fails_now() {
            drop(machine);
            resume_unwind(Box::new("the driver fails"));
        }
        if !self.in_flight.admits(now, model, frame) {
            return Written::Refused;
        }
        if machine.port.is_stalled(now) {
            machine.advance(now + WRITE_TAKES);
            return Written::Refused;
        }
        machine.world.transmit(now, frame.bytes());
        self.in_flight.handed_over(now, model, frame);
        Written::Taken
    }

    fn has_received(&mut self) {
        self.in_flight.received();
    }
}

impl Drop for SimulatedLine {
    fn drop(&mut self) {
        let mut machine = self.machine.borrow_mut();
        if machine.port.unplugged == self.unplugged {
            machine.port.open = None;
        }
    }
}

/// The disk.
#[derive(Debug)]
struct SimulatedStore(Rc<RefCell<Machine>>);

impl Store for SimulatedStore {
    fn write(&mut self, content: &[u8]) -> io::Result<()> {
        self.0.borrow_mut().write(content)
    }
}
