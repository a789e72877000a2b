//! A session worker that does what the test says, and the panel `Session file` over it.

use std::{cell::RefCell, rc::Rc};

use js_sys::{Array, Function, Uint8Array};
use motorlink_messages::{
    decode, encode,
    protocol::{Faults, MotorId},
    sessions::{FromSessions, Problem, SessionInfo, SessionMark, SessionMotor, ToSessions},
};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use web_sys::{Blob, BroadcastChannel, MessageEvent};

use crate::bench::{Bench, LOOKS_MAX, pause};

pub struct FakeSessions {
    channel: BroadcastChannel,
    /// Each message, and the number of objects that came with it.
    received: Rc<RefCell<Vec<(ToSessions, u32)>>>,
    /// The last of them that the test has seen.
    last: RefCell<String>,
    _on_message: Closure<dyn FnMut(MessageEvent)>,
}

impl FakeSessions {
    /// The session worker of the page that will be mounted under this name.
    pub fn new(name: &str) -> Self {
        let channel = BroadcastChannel::new(&format!("{name}-sessions")).unwrap();
        let received: Rc<RefCell<Vec<_>>> = Rc::default();
        let keep = received.clone();
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            // Its first message says that it runs.
            let Ok(parts) = event.data().dyn_into::<Array>() else {
                return;
            };
            let message = decode(&Uint8Array::new(&parts.get(0)).to_vec()).unwrap();
            keep.borrow_mut().push((message, parts.length() - 1));
        });
        channel.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
        Self {
            channel,
            received,
            last: RefCell::default(),
            _on_message: on_message,
        }
    }

    /// The next message, and the number of objects that came with it.
    pub async fn next(&self) -> (ToSessions, u32) {
        for _ in 0..LOOKS_MAX {
            if !self.received.borrow().is_empty() {
                let next = self.received.borrow_mut().remove(0);
                self.last.replace(format!("{:?}", next.0));
                return next;
            }
            pause(20).await;
        }
        panic!(
            "the session worker was sent nothing after {}",
            self.last.borrow()
        );
    }

    /// What it was sent since the last call, after all of it has arrived.
    pub async fn received(&self) -> Vec<ToSessions> {
        pause(200).await;
        let received = std::mem::take(&mut *self.received.borrow_mut());
        received.into_iter().map(|(message, _)| message).collect()
    }

    pub fn post(&self, message: &FromSessions) {
        let bytes = Uint8Array::from(encode(message).unwrap().as_slice());
        self.channel.post_message(&bytes).unwrap();
    }

    /// The same with a file of this content.
    pub fn post_file(&self, message: &FromSessions, content: &str) {
        let bytes = Uint8Array::from(encode(message).unwrap().as_slice());
        let parts = Array::of1(&content.into());
        let file = Blob::new_with_str_sequence(&parts).unwrap();
        self.channel
            .post_message(&Array::of2(&bytes, &file))
            .unwrap();
    }
}

impl Drop for FakeSessions {
    fn drop(&mut self) {
        self.channel.close();
    }
}

/// Runs a script in the page.
pub fn run(script: &str) {
    let run = Function::new_no_args(script);
    run.call0(&JsValue::UNDEFINED).unwrap();
}

pub async fn until_said(bench: &Bench, text: &str) {
    let says = || bench.text("status", "Session file").contains(text);
    bench.until(text, says).await;
}

fn motor(id: u8, replies: u64, seconds: usize) -> SessionMotor {
    SessionMotor {
        id: MotorId::new(id).unwrap(),
        replies,
        lost: 10,
        faults: Faults::from_byte(8),
        temperature_max_c: Some(41),
        speeds: vec![Some([-100, 200]); seconds],
        currents: vec![Some([0, 3_000]); seconds],
    }
}

fn mark(after_us: u64) -> SessionMark {
    SessionMark {
        after_us,
        error: true,
        text: "Standstill not confirmed".to_owned(),
        is_bookmark: false,
    }
}

/// What is in a file.
pub fn info() -> SessionInfo {
    SessionInfo {
        name: "run <b>.mcap".to_owned(),
        bytes: 1_200_000,
        version: "0.1.0".to_owned(),
        setup: r#"{"motorlink_setup":1,"motors":[
            {"id":1,"name":"Front left","side":"left","drives_together":true},
            {"id":2,"name":"Front right","side":"right","drives_together":true}]}"#
            .to_owned(),
        from_unix_us: 1_795_266_900_000_000,
        duration_us: 65_250_000,
        bucket_us: 1_000_000,
        sent: 6_000,
        received: 5_990,
        lost: 10,
        junk: 0,
        motors: vec![motor(1, 5_990, 65), motor(2, 0, 0)],
        marks: vec![mark(2_000_000), mark(4_000_000)],
        marks_left_out: 3,
        runs: vec!["Step <i>response</i>".to_owned()],
        runs_left_out: 4,
        problems: vec![(Problem::Cut, 1), (Problem::ChunkDamaged, 2)],
    }
}

/// Drops a file onto the page.
pub fn drop_file(name: &str) {
    run(&format!(
        "const transfer = new DataTransfer();
        transfer.items.add(new File(['x'], '{name}'));
        const drop = new DragEvent('drop', {{ dataTransfer: transfer, bubbles: true, cancelable: true }});
        document.body.dispatchEvent(drop);
        if (!drop.defaultPrevented) throw new Error('the browser would leave the page');"
    ));
}
