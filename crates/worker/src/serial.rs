//! Web Serial: opening, reading, writing and closing a port, and what its errors mean.

use std::{
    cell::RefCell,
    future::{Future, poll_fn},
    pin::pin,
    rc::Rc,
    task::Poll,
    time::Duration,
};

use gloo_timers::future::sleep;
use js_sys::{Object, Promise, Reflect, Uint8Array};
use motorlink_bus::InFlight;
use motorlink_messages::{ConnectError, LineError, PortRef, UsbId};
use motorlink_port::Written;
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

/// How long a port that does not open is tried again before the causes are named. After a reload, a crash or a replug
/// the system holds it for about a second (betaflight-configurator#5109, WICG/serial#156).
pub(crate) const REOPEN_WITHIN: Duration = Duration::from_secs(2);
/// How long a port may still be closing after an earlier trial.
pub(crate) const JUST_CLOSED: Duration = Duration::from_millis(400);
/// Pause between two tries. Closing a port takes 4 ms.
const REOPEN_PAUSE: Duration = Duration::from_millis(40);
/// How long a port that is closed is waited for. Closing takes 4 ms; after a sleep of the computer some drivers never
/// end a read (themactep/thingino-firmware#1595).
const CLOSE_WITHIN: Duration = Duration::from_millis(500);
/// How long a port may be without a stream after an error of the line: 0 to 50 ms (espressif/esptool-js#230).
const RENEWED_WITHIN: Duration = Duration::from_millis(200);
/// How often to look for it.
const RENEWED_STEP: Duration = Duration::from_millis(5);

/// An open port.
pub(crate) struct SerialLine {
    port: SerialPort,
    writer: Option<Writer>,
    in_flight: InFlight,
    usb: Option<UsbId>,
    /// The other ports of the same make when it was opened.
    pub(crate) others_of_make: Vec<SerialPort>,
}

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
    /// An error of the line. The port stays open.
    LineError(LineError),
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
        .map_err(|error| open_error(&error))?;
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

/// Opens the port that the page has chosen, at the baud rate of this model. A port that does not open is tried again
/// while `again` returns true.
pub(crate) async fn open(
    wanted: PortRef,
    model: Model,
    again: impl Fn() -> bool,
) -> Result<SerialLine, ConnectError> {
    let options = SerialOptions::new(model.spec().baud);
    options.set_buffer_size(BUFFER_BYTES);
    loop {
        let ports = ports().await?;
        let port = ports
            .get(usize::from(wanted.place))
            .filter(|port| usb_of(port) == wanted.usb)
            .ok_or(ConnectError::PortGone)?
            .clone();
        let error = match JsFuture::from(port.open(&options)).await {
            Ok(_) => {
                let is_other =
                    |other: &SerialPort| usb_of(other) == wanted.usb && !Object::is(other, &port);
                return Ok(SerialLine {
                    others_of_make: ports.into_iter().filter(is_other).collect(),
                    ..SerialLine::new(port.clone())
                });
            }
            Err(error) => open_error(&error),
        };
        let may_open_soon = matches!(error, ConnectError::OpenFailed | ConnectError::AlreadyOpen);
        if !may_open_soon || !again() {
            return Err(error);
        }
        sleep(REOPEN_PAUSE).await;
    }
}

impl SerialLine {
    pub(crate) const fn usb(&self) -> Option<UsbId> {
        self.usb
    }

    fn new(port: SerialPort) -> Self {
        Self {
            usb: usb_of(&port),
            writer: None,
            in_flight: InFlight::default(),
            others_of_make: Vec::new(),
            port,
        }
    }

    /// Writes a frame to the port, unless it would have to wait behind others: then it is already late,
    /// and the motor may have stopped meanwhile.
    ///
    /// A successful write proves nothing: the first write after an unplug succeeds too. Failures show
    /// on the reading side.
    pub(crate) fn write(&mut self, now: Instant, model: Model, frame: &Frame) -> Written {
        let is_admitted = self.in_flight.admits(now, model, frame);
        let Some(writer) = self
            .writer()
            .filter(|writer| is_admitted && writer.is_empty())
        else {
            return Written::Refused;
        };
        // A new array, because the browser may read it after this returns.
        let bytes = Uint8Array::from(frame.bytes().as_slice());
        let written = writer.end.write_with_chunk(&bytes);
        let _ = IGNORE.with(|ignore| written.catch(ignore));
        self.in_flight.handed_over(now, model, frame);
        Written::Taken
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

    /// Bytes have arrived: the line carries frames.
    pub(crate) fn has_received(&mut self) {
        self.in_flight.received();
    }

    pub(crate) fn port(&self) -> SerialPort {
        self.port.clone()
    }
}

/// Reads a port until it is closed or lost.
///
/// Every new reader is passed to `wanted`, so that it can be cancelled; `wanted` returns whether to
/// read on.
pub(crate) async fn read(
    port: SerialPort,
    mut wanted: impl FnMut(Option<ReadableStreamDefaultReader>) -> bool,
    on_event: impl Fn(ReadEvent) + 'static,
) -> ReadEnd {
    let on_event: Rc<dyn Fn(ReadEvent)> = Rc::new(on_event);
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
        let Err(error) = ended else {
            wanted(None);
            return ReadEnd::Closed;
        };
        // After a line error there is a new stream, at once or soon; after an unplug there is none.
        let is_unplugged = name_of(&error) == "NetworkError";
        let mut left = RENEWED_WITHIN.as_millis() / RENEWED_STEP.as_millis();
        while readable(&port).is_none() && !is_unplugged && left > 0 {
            if !wanted(None) {
                return ReadEnd::Closed;
            }
            sleep(RENEWED_STEP).await;
            left -= 1;
        }
        if readable(&port).is_some() {
            on_event(ReadEvent::LineError(line_error(&error)));
        }
    }
    if wanted(None) {
        ReadEnd::Lost
    } else {
        ReadEnd::Closed
    }
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

/// Closes a port: reader cancelled, locks released, then the port itself. Each is waited for within a bound.
pub(crate) async fn close(mut line: SerialLine, reader: Option<ReadableStreamDefaultReader>) {
    if let Some(reader) = reader
        && within(CLOSE_WITHIN, reader.cancel()).await.is_none()
    {
        // A port with a locked stream does not close.
        reader.release_lock();
    }
    line.release();
    // It fails if the adapter is gone; then there is nothing to close.
    within(CLOSE_WITHIN, line.port.close().unchecked_into()).await;
}

/// The result of a promise, or `None` if it does not settle in this time.
async fn within(limit: Duration, promise: Promise) -> Option<Result<JsValue, JsValue>> {
    let mut settled = pin!(JsFuture::from(promise));
    let mut late = pin!(sleep(limit));
    poll_fn(|context| match settled.as_mut().poll(context) {
        Poll::Ready(result) => Poll::Ready(Some(result)),
        Poll::Pending => late.as_mut().poll(context).map(|()| None),
    })
    .await
}

/// `port.readable`, which is null once the adapter is gone or the port is closed.
fn readable(port: &SerialPort) -> Option<ReadableStream> {
    Reflect::get(port, &"readable".into()).ok()?.dyn_into().ok()
}

/// `port.writable`, likewise.
fn writable(port: &SerialPort) -> Option<WritableStream> {
    Reflect::get(port, &"writable".into()).ok()?.dyn_into().ok()
}

fn name_of(error: &JsValue) -> String {
    let error = error.dyn_ref::<DomException>();
    error.map(DomException::name).unwrap_or_default()
}

fn open_error(error: &JsValue) -> ConnectError {
    match name_of(error).as_str() {
        "NetworkError" => ConnectError::OpenFailed,
        "InvalidStateError" => ConnectError::AlreadyOpen,
        "SecurityError" | "NotAllowedError" => ConnectError::Forbidden,
        _ => other(error),
    }
}

fn line_error(error: &JsValue) -> LineError {
    match name_of(error).as_str() {
        "BreakError" => LineError::Break,
        "FramingError" => LineError::Framing,
        "ParityError" => LineError::Parity,
        "BufferOverrunError" => LineError::Overrun,
        _ => LineError::Other,
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
        line.write(now, Model::Ddsm115, &frame) == Written::Taken
    }

    fn rows(places: &[u8]) -> Vec<Vec<u8>> {
        let frames = places.iter().map(|place| query(*place).1);
        frames.map(|frame| frame.bytes().to_vec()).collect()
    }

    #[wasm_bindgen_test]
    async fn a_frame_that_was_written_is_not_overwritten_by_the_next() {
        let port = port();
        let mut line = SerialLine::new(port.clone());
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
        let mut line = SerialLine::new(port.clone());
        turn().await;
        assert!(write(&mut line, query(1)));
        turn().await;
        assert!(!write(&mut line, query(2)));
        assert_eq!(got(&port), rows(&[1]));
    }

    #[wasm_bindgen_test]
    async fn behind_a_write_that_failed_frames_go_to_the_new_stream() {
        let port = port();
        let mut line = SerialLine::new(port.clone());
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
        let mut line = SerialLine::new(port.clone());
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
        let mut line = SerialLine::new(port);
        let rpm = |rpm| Setpoint::velocity(SpeedTarget::new(rpm).unwrap());
        let drive = Request::drive(MotorId::FIRST, rpm(100)).frame();
        let brake = Request::drive(MotorId::FIRST, Setpoint::Brake).frame();
        let taken = |line: &mut SerialLine, millis, frame| {
            write(line, (Instant::from_millis(millis), frame))
        };
        turn().await;
        assert!(taken(&mut line, 10, drive));
        turn().await;
        assert!(!taken(&mut line, 20, drive));
        assert!(taken(&mut line, 20, brake));
        turn().await;
        line.has_received();
        assert!(taken(&mut line, 30, drive));
    }
}
