//! The WebSocket to the server that this worker comes from.

use js_sys::{ArrayBuffer, Uint8Array};
use motorlink_messages::{decode, encode};
use motorlink_remote::{FromServer, ToServer};
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{BinaryType, CloseEvent, MessageEvent, WebSocket};

use crate::scope::{global, report};

/// The server closes with this code if the page is of another version.
const OTHER_VERSION: u16 = 4001;
/// Bytes that wait to be sent. With more the network is down: what a person does now would come late.
const WAITING_BYTES_MAX: u32 = 64 * 1024;

/// Why a connection ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Closed {
    /// The server has gone, or the network.
    Lost,
    /// The server has another version.
    OtherVersion,
}

/// A connection. It ends when this is dropped.
pub(crate) struct Socket {
    web: WebSocket,
    _on_message: Closure<dyn FnMut(MessageEvent)>,
    _on_close: Closure<dyn FnMut(CloseEvent)>,
}

impl Socket {
    /// Connects. Returns nothing if the browser refuses the address.
    pub(crate) fn open(
        mut on_message: impl FnMut(FromServer) + 'static,
        mut on_close: impl FnMut(Closed) + 'static,
    ) -> Option<Self> {
        let socket = WebSocket::new(&address()).ok()?;
        socket.set_binary_type(BinaryType::Arraybuffer);
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            let Ok(buffer) = event.data().dyn_into::<ArrayBuffer>() else {
                return;
            };
            match decode(&Uint8Array::new(&buffer).to_vec()) {
                Ok(message) => on_message(message),
                Err(error) => report(
                    "the server sent no message of ours",
                    &error.to_string().into(),
                ),
            }
        });
        socket.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
        let on_close = Closure::<dyn FnMut(CloseEvent)>::new(move |event: CloseEvent| {
            on_close(match event.code() {
                OTHER_VERSION => Closed::OtherVersion,
                _ => Closed::Lost,
            });
        });
        socket.set_onclose(Some(on_close.as_ref().unchecked_ref()));
        Some(Self {
            web: socket,
            _on_message: on_message,
            _on_close: on_close,
        })
    }

    /// Sends a message. If the network takes none, only what stops motors waits for it.
    pub(crate) fn send(&self, message: &ToServer, stops: bool) {
        let is_open = self.web.ready_state() == WebSocket::OPEN;
        if is_open
            && (stops || self.web.buffered_amount() < WAITING_BYTES_MAX)
            && let Ok(bytes) = encode(message)
            && let Err(error) = self.web.send_with_u8_array(&bytes)
        {
            report("a message to the server was not taken", &error);
        }
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        self.web.set_onmessage(None);
        self.web.set_onclose(None);
        // It may be closed already.
        let _ = self.web.close();
    }
}

/// The address of the server, with the name of this program as the version of the page.
fn address() -> String {
    let location = global().location();
    let scheme = if location.protocol() == "https:" {
        "wss"
    } else {
        "ws"
    };
    let path = location.pathname();
    let name = path.rsplit('/').next().unwrap_or_default();
    format!("{scheme}://{}/motorlink?page={name}", location.host())
}
