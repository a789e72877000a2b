//! Asks the recorder whether there is anything to save, before the browser's dialog is opened: the browser empties a
//! file as soon as the user chooses it there.

use js_sys::{Promise, Uint8Array};
use leptos::prelude::{WithValue, window};
use motorlink_messages::{decode, sessions::NotSaved};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::{MessageChannel, MessageEvent};

use crate::model::recorder::Recorder;

/// A recorder that works has an answer within a turn of 8 ms. Chromium opens the dialog up to 5 s after a press.
const WAIT_MS: i32 = 1_000;

/// Why nothing can be saved now. Without an answer there is no reason.
pub(super) async fn not_kept(recorder: &Recorder) -> Option<NotSaved> {
    let channel = MessageChannel::new().ok()?;
    recorder.link.with_value(|link| {
        if let Some(link) = link {
            link.hand_over(&channel.port1());
        }
    });
    let port = channel.port2();
    let answer = Promise::new(&mut |resolve, _| {
        port.set_onmessage(Some(&resolve));
        // Without a timeout, the dialog would not wait either.
        let _ = window().set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, WAIT_MS);
    });
    port.post_message(&JsValue::NULL).ok()?;
    let answer = JsFuture::from(answer).await.ok()?;
    port.close();
    let event = answer.dyn_into::<MessageEvent>().ok()?;
    decode(&Uint8Array::new(&event.data()).to_vec()).ok()?
}
