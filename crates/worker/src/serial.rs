//! Web Serial: opening, reading, writing and closing a port, and what its errors mean.

use std::{
    cell::{Cell, RefCell},
    rc::Rc,
    time::Duration,
};

use gloo_timers::future::sleep;
use js_sys::{Promise, Reflect, Uint8Array};
use motorlink_bus::InFlight;
use motorlink_messages::{ConnectError, PortRef, UsbId};
use motorlink_protocol::{Frame, Instant, family::Model};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    DomException, Event, ReadableStream, ReadableStreamDefaultReader, ReadableStreamReadResult,
    Serial, SerialOptions, SerialPort, WritableStream, WritableStreamDefaultWriter,
};

use crate::scope::{global, report};

/// The browser's receive buffer; its default of 255 bytes holds three chunks of a busy adapter.
const BUFFER_BYTES: u32 = 16_384;

/// Tries to open a port that is still being closed. Closing takes 4 ms.
const REOPEN_TRIES: u32 = 20;
const REOPEN_PAUSE: Duration = Duration::from_millis(20);

/// An open port.
pub(crate) struct SerialLine {
    port: SerialPort,
    writer: Option<Writer>,
    in_flight: SharedInFlight,
    usb: Option<UsbId>,
    /// The model of the motors, which decides the baud rate.
    model: Model,
}

/// Frames that may not have been sent yet: the writing side adds them, the reading side confirms them.
pub(crate) type SharedInFlight = Rc<Cell<InFlight>>;

/// The writer of a port. A line error ends its stream.
struct Writer {
    stream: WritableStream,
    end: WritableStreamDefaultWriter,
    /// The desired size of an empty stream: one chunk in Chromium 156; the buffer size of the port
    /// by the specification.
    room_when_empty: f64,
}

impl Writer {
    fn new(stream: WritableStream) -> Option<Self> {
        let end = WritableStreamDefaultWriter::new(&stream).ok()?;
        let room_when_empty = end.desired_size().ok().flatten()?;
        Some(Self {
            stream,
            end,
            room_when_empty,
        })
    }

    /// Whether no earlier frame waits in the stream. A failed stream has no room.
    fn is_empty(&self) -> bool {
        let room = self.end.desired_size().ok().flatten();
        room.is_some_and(|room| room >= self.room_when_empty)
    }
}

thread_local! {
    /// Ignores the rejection of a write, because the reading side reports it too. It outlives every
    /// port, because a write may fail after its port was dropped.
    static IGNORE: Closure<dyn FnMut(JsValue)> = Closure::new(|_| {});
}

/// Why [`read`] ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ReadEnd {
    /// The worker closed the port.
    Closed,
    /// The adapter is gone.
    Lost,
}

/// An event of [`read`].
#[derive(Debug)]
pub(crate) enum ReadEvent<'a> {
    /// Bytes came.
    Bytes(&'a [u8]),
    /// A break, framing, parity or overrun error. The port stays open.
    LineError,
}

/// `navigator.serial`, where the browser has it in workers.
pub(crate) fn serial() -> Option<Serial> {
    let navigator = global().navigator();
    let there = Reflect::has(&navigator, &"serial".into()).unwrap_or(false);
    there.then(|| navigator.serial())
}

/// Calls `plugged` whenever an adapter is plugged in for which the user has given permission.
pub(crate) fn on_plugged(mut plugged: impl FnMut() + 'static) {
    let Some(serial) = serial() else { return };
    let handler = Closure::<dyn FnMut(Event)>::new(move |_| plugged());
    serial.set_onconnect(Some(handler.as_ref().unchecked_ref()));
    handler.forget();
}

/// The ports for which the user has given permission, in the same order as in the page.
pub(crate) async fn ports() -> Result<Vec<SerialPort>, ConnectError> {
    let serial = serial().ok_or(ConnectError::NoWebSerial)?;
    let ports = JsFuture::from(serial.get_ports())
        .await
        .map_err(|error| other(&error))?;
    let ports = js_sys::Array::from(ports.as_ref());
    Ok(ports.iter().map(JsCast::unchecked_into).collect())
}

/// The USB IDs of a port, if it has any.
pub(crate) fn usb_of(port: &SerialPort) -> Option<UsbId> {
    let info = port.get_info();
    Some(UsbId {
        vendor: info.get_usb_vendor_id()?,
        product: info.get_usb_product_id()?,
    })
}

/// Opens the port that the page has chosen, at the baud rate of this model.
pub(crate) async fn open(wanted: PortRef, model: Model) -> Result<SerialLine, ConnectError> {
    let ports = ports().await?;
    let port = ports
        .get(usize::from(wanted.place))
        .filter(|port| usb_of(port) == wanted.usb)
        .ok_or(ConnectError::PortGone)?
        .clone();
    let options = SerialOptions::new(model.spec().baud);
    options.set_buffer_size(BUFFER_BYTES);
    let mut tries = 0;
    loop {
        match JsFuture::from(port.open(&options)).await {
            Ok(_) => break,
            // It is still being closed after an earlier session.
            Err(error) if is_open_already(&error) && tries < REOPEN_TRIES => {
                tries += 1;
                sleep(REOPEN_PAUSE).await;
            }
            Err(error) => return Err(open_error(&error)),
        }
    }
    Ok(SerialLine::new(port, model))
}

impl SerialLine {
    pub(crate) const fn usb(&self) -> Option<UsbId> {
        self.usb
    }

    fn new(port: SerialPort, model: Model) -> Self {
        Self {
            model,
            usb: usb_of(&port),
            writer: None,
            in_flight: SharedInFlight::default(),
            port,
        }
    }

    /// Writes a frame to the port, unless it would have to wait behind others: then it is already late,
    /// and the motor may have stopped meanwhile. Returns whether the frame was written.
    ///
    /// A successful write proves nothing: the first write after an unplug succeeds too. Failures show
    /// on the reading side.
    pub(crate) fn write(&mut self, now: Instant, frame: Frame) -> bool {
        let (model, mut in_flight) = (self.model, self.in_flight.get());
        let Some(writer) = self.writer() else {
            return false;
        };
        let accepts = writer.is_empty() && in_flight.admits(now, model, &frame);
        if accepts {
            // A new array, because the browser may read it after this returns.
            let bytes = Uint8Array::from(frame.bytes().as_slice());
            let written = writer.end.write_with_chunk(&bytes);
            let _ = IGNORE.with(|ignore| written.catch(ignore));
            in_flight.handed_over(now, model, &frame);
            self.in_flight.set(in_flight);
        }
        accepts
    }

    /// The writer. A line error ends its stream, and the port then has another stream; frames written to
    /// the old one would be lost.
    fn writer(&mut self) -> Option<&Writer> {
        let stream = writable(&self.port);
        let kept = self.writer.as_ref().map(|writer| &writer.stream);
        if kept != stream.as_ref() {
            self.release();
            self.writer = stream.and_then(Writer::new);
        }
        self.writer.as_ref()
    }

    fn release(&mut self) {
        if let Some(old) = self.writer.take() {
            old.end.release_lock();
        }
    }

    /// The frames in flight; [`read`] confirms them.
    pub(crate) fn in_flight(&self) -> SharedInFlight {
        Rc::clone(&self.in_flight)
    }

    pub(crate) fn port(&self) -> SerialPort {
        self.port.clone()
    }
}

/// Reads a port until it is closed or lost.
///
/// Every new reader is passed to `wanted`, so that it can be cancelled; `wanted` returns whether to
/// read on. Received bytes confirm the frames `in_flight`.
pub(crate) async fn read(
    port: SerialPort,
    in_flight: SharedInFlight,
    mut wanted: impl FnMut(Option<ReadableStreamDefaultReader>) -> bool,
    on_event: impl Fn(ReadEvent) + 'static,
) -> ReadEnd {
    let on_event: Rc<dyn Fn(ReadEvent)> = Rc::new(move |event: ReadEvent| {
        if let ReadEvent::Bytes(_) = event {
            let mut proved = in_flight.get();
            proved.received();
            in_flight.set(proved);
        }
        on_event(event);
    });
    while let Some(stream) = readable(&port) {
        let Ok(reader) = ReadableStreamDefaultReader::new(&stream) else {
            return ReadEnd::Lost;
        };
        if !wanted(Some(reader.clone())) {
            reader.release_lock();
            return ReadEnd::Closed;
        }
        let ended = read_stream(&reader, &on_event).await;
        reader.release_lock();
        match ended {
            Ok(()) => {
                wanted(None);
                return ReadEnd::Closed;
            }
            // After a line error there is a new stream; after an unplug there is none.
            Err(_) if readable(&port).is_some() => on_event(ReadEvent::LineError),
            Err(_) => {}
        }
    }
    wanted(None);
    ReadEnd::Lost
}

/// Bytes copied out of the browser at a time: three frames with their echoes.
const CHUNK: u32 = 64;

/// Reads one stream to its end (`Ok`) or its error.
///
/// One closure handles all chunks of the stream. A future for each chunk would allocate four times and
/// run one turn of the event loop later, which would delay the request after a reply.
async fn read_stream(
    reader: &ReadableStreamDefaultReader,
    on_event: &Rc<dyn Fn(ReadEvent)>,
) -> Result<(), JsValue> {
    let on_chunk: Rc<RefCell<Option<OnSettled>>> = Rc::default();
    let mut on_error: Option<Rc<OnSettled>> = None;
    let ended = Promise::new(&mut |resolve, reject| {
        let failed = Rc::new(OnSettled::new(move |error| {
            let _ = reject.call1(&JsValue::UNDEFINED, &error);
        }));
        on_error = Some(Rc::clone(&failed));
        let (reader, on_event, again) = (
            reader.clone(),
            Rc::clone(on_event),
            Rc::downgrade(&on_chunk),
        );
        *on_chunk.borrow_mut() = Some(OnSettled::new(move |result: JsValue| {
            let result: ReadableStreamReadResult = result.unchecked_into();
            if result.get_done().unwrap_or(true) {
                let _ = resolve.call0(&JsValue::UNDEFINED);
                return;
            }
            if let Ok(bytes) = result.get_value().dyn_into::<Uint8Array>() {
                deliver_bytes(&bytes, &*on_event);
            }
            if let Some(again) = again.upgrade()
                && let Some(on_chunk) = &*again.borrow()
            {
                let _ = reader.read().then2(on_chunk, &failed);
            }
        }));
    });
    if let (Some(on_chunk), Some(on_error)) = (&*on_chunk.borrow(), &on_error) {
        let _ = reader.read().then2(on_chunk, on_error);
    }
    JsFuture::from(ended).await.map(drop)
}

/// Called with the result or the error of a promise.
type OnSettled = Closure<dyn FnMut(JsValue)>;

fn deliver_bytes(bytes: &Uint8Array, on_event: &dyn Fn(ReadEvent)) {
    let mut chunk = [0; CHUNK as usize];
    let mut from = 0;
    while from < bytes.length() {
        let until = bytes.length().min(from + CHUNK);
        let part = bytes.subarray(from, until);
        if let Some(chunk) = chunk.get_mut(..(until - from) as usize) {
            part.copy_to(chunk);
            on_event(ReadEvent::Bytes(chunk));
        }
        from = until;
    }
}

/// Closes a port: reader cancelled, locks released, then the port itself.
pub(crate) async fn close(mut line: SerialLine, reader: Option<ReadableStreamDefaultReader>) {
    if let Some(reader) = reader {
        let _ = JsFuture::from(reader.cancel()).await;
    }
    line.release();
    // It fails if the adapter is gone; then there is nothing to close.
    let _ = JsFuture::from(line.port.close()).await;
}

/// `port.readable`, which is null once the adapter is gone or the port is closed.
fn readable(port: &SerialPort) -> Option<ReadableStream> {
    Reflect::get(port, &"readable".into()).ok()?.dyn_into().ok()
}

/// `port.writable`, likewise.
fn writable(port: &SerialPort) -> Option<WritableStream> {
    Reflect::get(port, &"writable".into()).ok()?.dyn_into().ok()
}

fn is_open_already(error: &JsValue) -> bool {
    matches!(open_error(error), ConnectError::AlreadyOpen)
}

fn open_error(error: &JsValue) -> ConnectError {
    match error
        .dyn_ref::<DomException>()
        .map(DomException::name)
        .as_deref()
    {
        Some("NetworkError") => ConnectError::OpenFailed,
        Some("InvalidStateError") => ConnectError::AlreadyOpen,
        _ => other(error),
    }
}

fn other(error: &JsValue) -> ConnectError {
    report("a port could not be opened", error);
    ConnectError::Other
}

#[cfg(test)]
mod tests {
    use js_sys::{Array, eval};
    use motorlink_protocol::{MotorId, Request, Setpoint, SpeedTarget};
    use wasm_bindgen_test::wasm_bindgen_test;

    use super::*;

    /// A port whose stream collects all chunks in `got`. `fails` makes the next write fail as after a line
    /// error; `holds` makes writes never complete.
    const PORT: &str = "(() => {
        const port = { got: [], fails: false, holds: false, getInfo: () => ({}) };
        const renew = () => { port.writable = new WritableStream({ write(chunk) {
            if (port.fails) {
                port.fails = false;
                renew();
                throw new DOMException('An unknown system error has occurred.', 'UnknownError');
            }
            port.got.push(chunk);
            if (port.holds) return new Promise(() => {});
        } }, new ByteLengthQueuingStrategy({ highWaterMark: 16384 })); };
        renew();
        return port;
    })()";

    fn port() -> SerialPort {
        eval(PORT).unwrap().unchecked_into()
    }

    fn set(port: &SerialPort, property: &str, value: impl Into<JsValue>) {
        Reflect::set(port, &property.into(), &value.into()).unwrap();
    }

    /// The frames that were written to the port.
    fn got(port: &SerialPort) -> Vec<Vec<u8>> {
        let got: Array = Reflect::get(port, &"got".into()).unwrap().unchecked_into();
        got.iter()
            .map(|chunk| Uint8Array::from(chunk).to_vec())
            .collect()
    }

    /// Lets the streams make progress.
    async fn turn() {
        sleep(Duration::from_millis(1)).await;
    }

    /// A frame for each `place` and a moment for it, far from the one before.
    fn query(place: u8) -> (Instant, Frame) {
        let id = MotorId::new(place).unwrap();
        let now = Instant::from_millis(u64::from(place) * 10);
        (now, Request::Query { id }.frame())
    }

    fn write(line: &mut SerialLine, (now, frame): (Instant, Frame)) -> bool {
        line.write(now, frame)
    }

    fn rows(places: &[u8]) -> Vec<Vec<u8>> {
        let frames = places.iter().map(|place| query(*place).1);
        frames.map(|frame| frame.bytes().to_vec()).collect()
    }

    #[wasm_bindgen_test]
    async fn a_frame_that_was_written_is_not_overwritten_by_the_next() {
        let port = port();
        let mut line = SerialLine::new(port.clone(), Model::Ddsm115);
        for place in 1..=3 {
            turn().await;
            assert!(write(&mut line, query(place)));
        }
        turn().await;
        assert_eq!(got(&port), rows(&[1, 2, 3]));
    }

    #[wasm_bindgen_test]
    async fn behind_a_frame_that_waits_in_the_stream_none_is_taken() {
        let port = port();
        set(&port, "holds", true);
        let mut line = SerialLine::new(port.clone(), Model::Ddsm115);
        turn().await;
        assert!(write(&mut line, query(1)));
        turn().await;
        assert!(!write(&mut line, query(2)));
        assert_eq!(got(&port), rows(&[1]));
    }

    #[wasm_bindgen_test]
    async fn behind_a_write_that_failed_frames_go_to_the_new_stream() {
        let port = port();
        let mut line = SerialLine::new(port.clone(), Model::Ddsm115);
        turn().await;
        set(&port, "fails", true);
        write(&mut line, query(1));
        turn().await;
        assert!(write(&mut line, query(2)));
        turn().await;
        assert!(write(&mut line, query(3)));
        turn().await;
        assert_eq!(got(&port), rows(&[2, 3]));
    }

    #[wasm_bindgen_test]
    async fn a_frame_is_not_taken_where_the_port_has_no_stream_any_more() {
        let port = port();
        let mut line = SerialLine::new(port.clone(), Model::Ddsm115);
        turn().await;
        assert!(write(&mut line, query(1)));
        set(&port, "writable", JsValue::NULL);
        turn().await;
        assert!(!write(&mut line, query(2)));
        assert_eq!(got(&port), rows(&[1]));
    }

    #[wasm_bindgen_test]
    async fn a_drive_frame_is_not_taken_behind_another_before_a_byte_has_come() {
        let port = port();
        let mut line = SerialLine::new(port, Model::Ddsm115);
        let rpm = |rpm| Setpoint::velocity(SpeedTarget::new(rpm).unwrap());
        let drive = Request::drive(MotorId::FIRST, rpm(100)).frame();
        let brake = Request::drive(MotorId::FIRST, Setpoint::Brake).frame();
        let taken =
            |line: &mut SerialLine, millis, frame| line.write(Instant::from_millis(millis), frame);
        turn().await;
        assert!(taken(&mut line, 10, drive));
        turn().await;
        assert!(!taken(&mut line, 20, drive));
        assert!(taken(&mut line, 20, brake));
        turn().await;
        let in_flight = line.in_flight();
        let mut proved = in_flight.get();
        proved.received();
        in_flight.set(proved);
        assert!(taken(&mut line, 30, drive));
    }
}
