//! Web Serial: opening, reading, writing and closing a port, and what its errors mean.

use std::{cell::RefCell, rc::Rc, time::Duration};

use gloo_timers::future::sleep;
use js_sys::{Promise, Reflect, Uint8Array};
use motorlink_messages::{ConnectError, PortRef, UsbId};
use motorlink_protocol::{FRAME_LEN, Frame};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    DomException, Event, ReadableStream, ReadableStreamDefaultReader, ReadableStreamReadResult,
    Serial, SerialOptions, SerialPort, WritableStreamDefaultWriter,
};

use crate::scope::{global, report};

/// The only rate that the motors speak.
const BAUD: u32 = 115_200;
/// Bytes that the browser may hold for us; its default of 255 is three chunks of a busy adapter.
const BUFFER_BYTES: u32 = 16_384;

/// A port that is being closed is tried again: this often, this far apart. Closing takes 4 ms.
const REOPEN_TRIES: u32 = 20;
const REOPEN_PAUSE: Duration = Duration::from_millis(20);

/// An open port.
pub(crate) struct SerialLine {
    port: SerialPort,
    writer: WritableStreamDefaultWriter,
    /// The frame that is written. The browser is done with it when there is room for another.
    frame: Uint8Array,
    usb: Option<UsbId>,
}

thread_local! {
    /// Takes the rejection of a write, which the reading side reports as well. It outlives every
    /// port, since a write may fail after its port was given up.
    static IGNORE: Closure<dyn FnMut(JsValue)> = Closure::new(|_| {});
}

/// What ended a [`read`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ReadEnd {
    /// The port was closed by us.
    Closed,
    /// The adapter is gone.
    Lost,
}

/// What [`read`] tells.
#[derive(Debug)]
pub(crate) enum ReadEvent<'a> {
    /// Bytes came.
    Bytes(&'a [u8]),
    /// A break, framing, parity or overrun error. The port lives on.
    LineError,
}

/// `navigator.serial`, where the browser has it in workers.
pub(crate) fn serial() -> Option<Serial> {
    let navigator = global().navigator();
    let there = Reflect::has(&navigator, &"serial".into()).unwrap_or(false);
    there.then(|| navigator.serial())
}

/// Calls `plugged` whenever an adapter that may be used is plugged in.
pub(crate) fn on_plugged(mut plugged: impl FnMut() + 'static) {
    let Some(serial) = serial() else { return };
    let handler = Closure::<dyn FnMut(Event)>::new(move |_| plugged());
    serial.set_onconnect(Some(handler.as_ref().unchecked_ref()));
    handler.forget();
}

/// The ports that may be used, in the order in which the page sees them too.
pub(crate) async fn ports() -> Result<Vec<SerialPort>, ConnectError> {
    let serial = serial().ok_or(ConnectError::NoWebSerial)?;
    let ports = JsFuture::from(serial.get_ports())
        .await
        .map_err(|error| other(&error))?;
    let ports = js_sys::Array::from(ports.as_ref());
    Ok(ports.iter().map(JsCast::unchecked_into).collect())
}

/// What a port is, as far as the browser says.
pub(crate) fn usb_of(port: &SerialPort) -> Option<UsbId> {
    let info = port.get_info();
    Some(UsbId {
        vendor: info.get_usb_vendor_id()?,
        product: info.get_usb_product_id()?,
    })
}

/// Opens the port that the page means.
pub(crate) async fn open(wanted: PortRef) -> Result<SerialLine, ConnectError> {
    let ports = ports().await?;
    let port = ports
        .get(usize::from(wanted.place))
        .filter(|port| usb_of(port) == wanted.usb)
        .ok_or(ConnectError::PortGone)?
        .clone();
    let options = SerialOptions::new(BAUD);
    options.set_buffer_size(BUFFER_BYTES);
    let mut tries = 0;
    loop {
        match JsFuture::from(port.open(&options)).await {
            Ok(_) => break,
            // We are still closing it, after an earlier session.
            Err(error) if is_open_already(&error) && tries < REOPEN_TRIES => {
                tries += 1;
                sleep(REOPEN_PAUSE).await;
            }
            Err(error) => return Err(open_error(&error)),
        }
    }
    match WritableStreamDefaultWriter::new(&port.writable()) {
        Ok(writer) => Ok(SerialLine {
            usb: usb_of(&port),
            port,
            writer,
            frame: Uint8Array::from([0; FRAME_LEN].as_slice()),
        }),
        Err(error) => {
            let _ = JsFuture::from(port.close()).await;
            Err(other(&error))
        }
    }
}

impl SerialLine {
    pub(crate) const fn usb(&self) -> Option<UsbId> {
        self.usb
    }

    /// Hands a frame to the port, unless it would wait behind another: it is late already then, and
    /// would be sent to a motor that may have stopped meanwhile. Gives back whether it was handed over.
    ///
    /// That it was proves nothing: the first write after an unplug succeeds too. What failed shows on
    /// the reading side.
    pub(crate) fn write(&self, frame: Frame) -> bool {
        let room = self.writer.desired_size().ok().flatten();
        let has_room = room.is_none_or(|room| room > 0.0);
        if has_room {
            self.frame.copy_from(frame.bytes());
            let written = self.writer.write_with_chunk(&self.frame);
            let _ = IGNORE.with(|ignore| written.catch(ignore));
        }
        has_room
    }

    pub(crate) fn port(&self) -> SerialPort {
        self.port.clone()
    }
}

/// Reads a port until it is closed or lost.
///
/// `wanted` is told of every reader before it is used, so that it can be cancelled, and says whether
/// the port is still to be read.
pub(crate) async fn read(
    port: SerialPort,
    mut wanted: impl FnMut(Option<ReadableStreamDefaultReader>) -> bool,
    tell: impl Fn(ReadEvent) + 'static,
) -> ReadEnd {
    let tell: Rc<dyn Fn(ReadEvent)> = Rc::new(tell);
    while let Some(stream) = readable(&port) {
        let Ok(reader) = ReadableStreamDefaultReader::new(&stream) else {
            return ReadEnd::Lost;
        };
        if !wanted(Some(reader.clone())) {
            reader.release_lock();
            return ReadEnd::Closed;
        }
        let ended = read_stream(&reader, &tell).await;
        reader.release_lock();
        match ended {
            Ok(()) => {
                wanted(None);
                return ReadEnd::Closed;
            }
            // After an error of the line there is a new stream; after a loss there is none.
            Err(_) if readable(&port).is_some() => tell(ReadEvent::LineError),
            Err(_) => {}
        }
    }
    wanted(None);
    ReadEnd::Lost
}

/// Bytes that are copied out of the browser at a time: three frames with their echoes.
const CHUNK: u32 = 64;

/// Reads one stream to its end (`Ok`) or its error.
///
/// One closure hears every chunk, for as long as the stream lasts: a future for each would allocate
/// four times and come a turn of the event loop later, between a reply and the next request.
async fn read_stream(
    reader: &ReadableStreamDefaultReader,
    tell: &Rc<dyn Fn(ReadEvent)>,
) -> Result<(), JsValue> {
    let on_chunk: Rc<RefCell<Option<OnSettled>>> = Rc::default();
    let mut on_error: Option<Rc<OnSettled>> = None;
    let ended = Promise::new(&mut |resolve, reject| {
        let failed = Rc::new(OnSettled::new(move |error| {
            let _ = reject.call1(&JsValue::UNDEFINED, &error);
        }));
        on_error = Some(Rc::clone(&failed));
        let (reader, tell, again) = (reader.clone(), Rc::clone(tell), Rc::downgrade(&on_chunk));
        *on_chunk.borrow_mut() = Some(OnSettled::new(move |result: JsValue| {
            let result: ReadableStreamReadResult = result.unchecked_into();
            if result.get_done().unwrap_or(true) {
                let _ = resolve.call0(&JsValue::UNDEFINED);
                return;
            }
            if let Ok(bytes) = result.get_value().dyn_into::<Uint8Array>() {
                tell_bytes(&bytes, &*tell);
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

/// Called with what a promise has come to.
type OnSettled = Closure<dyn FnMut(JsValue)>;

fn tell_bytes(bytes: &Uint8Array, tell: &dyn Fn(ReadEvent)) {
    let mut chunk = [0; CHUNK as usize];
    let mut from = 0;
    while from < bytes.length() {
        let until = bytes.length().min(from + CHUNK);
        let part = bytes.subarray(from, until);
        if let Some(chunk) = chunk.get_mut(..(until - from) as usize) {
            part.copy_to(chunk);
            tell(ReadEvent::Bytes(chunk));
        }
        from = until;
    }
}

/// Closes a port: reader cancelled, locks released, then the port itself.
pub(crate) async fn close(line: SerialLine, reader: Option<ReadableStreamDefaultReader>) {
    if let Some(reader) = reader {
        let _ = JsFuture::from(reader.cancel()).await;
    }
    line.writer.release_lock();
    // It fails where the adapter is gone, and then there is nothing to close.
    let _ = JsFuture::from(line.port.close()).await;
}

/// `port.readable`, which is null once the adapter is gone or the port is closed.
fn readable(port: &SerialPort) -> Option<ReadableStream> {
    Reflect::get(port, &"readable".into()).ok()?.dyn_into().ok()
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
