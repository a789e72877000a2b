//! A recorder that keeps rows and answers looks, and otherwise says what it is bidden.

use std::{cell::RefCell, rc::Rc};

use js_sys::{Array, Uint8Array};
use motorlink_messages::{
    decode, encode,
    recorder::{FromRecorder, Kind, LogPage, Row, ToRecorder, Window},
};
use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{Blob, BroadcastChannel, MessageEvent};

use crate::bench::pause;

pub struct FakeRecorder {
    channel: BroadcastChannel,
    state: Rc<RefCell<State>>,
    _on_message: Closure<dyn FnMut(MessageEvent)>,
}

#[derive(Default)]
struct State {
    received: Vec<ToRecorder>,
    /// Whether it was given its end of the line to the other worker.
    connected: bool,
    rows: Vec<Row>,
    /// Those before it was cleared.
    cleared: Vec<Row>,
    /// Rows that gave way.
    gone: usize,
    window: Option<Window>,
    generation: u32,
}

impl FakeRecorder {
    /// The recorder of the page that will be mounted under this name.
    pub fn new(name: &str) -> Self {
        let channel = BroadcastChannel::new(&format!("{name}-recorder")).unwrap();
        let state = Rc::new(RefCell::new(State::default()));
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new({
            let (channel, state) = (channel.clone(), state.clone());
            move |event: MessageEvent| {
                let mut state = state.borrow_mut();
                match event.data().dyn_into::<Uint8Array>() {
                    Ok(bytes) => state.handle(decode(&bytes.to_vec()).unwrap()),
                    Err(other) => state.connected |= other.as_string().as_deref() == Some("line"),
                }
                if let Some(page) = state.page() {
                    post(&channel, &FromRecorder::Log(page), None);
                }
            }
        });
        channel.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
        Self {
            channel,
            state,
            _on_message: on_message,
        }
    }

    /// What it was received since the last call but looks, after all of it has arrived.
    pub async fn received(&self) -> Vec<ToRecorder> {
        pause(200).await;
        let received = std::mem::take(&mut self.state.borrow_mut().received);
        let not_look = |message: &ToRecorder| !matches!(message, ToRecorder::Show(_));
        received.into_iter().filter(not_look).collect()
    }

    pub fn is_connected(&self) -> bool {
        self.state.borrow().connected
    }

    /// So many more entries, each a frame of ours.
    pub fn log(&self, count: usize) {
        for _ in 0..count {
            let number = self.state.borrow().rows.len();
            self.state.borrow_mut().rows.push(row(number, Kind::Tx));
        }
        self.answer();
    }

    pub fn log_row(&self, change: impl FnOnce(&mut Row)) {
        let mut row = row(self.state.borrow().rows.len(), Kind::Tx);
        change(&mut row);
        self.state.borrow_mut().rows.push(row);
        self.answer();
    }

    /// The oldest rows give way.
    pub fn drop_oldest(&self, count: usize) {
        self.state.borrow_mut().gone += count;
        self.answer();
    }

    pub fn post(&self, message: &FromRecorder) {
        post(&self.channel, message, None);
    }

    pub fn post_with_file(&self, message: &FromRecorder, file: &Blob) {
        post(&self.channel, message, Some(file));
    }

    fn answer(&self) {
        let page = self.state.borrow().page();
        if let Some(page) = page {
            self.post(&FromRecorder::Log(page));
        }
    }
}

impl Drop for FakeRecorder {
    fn drop(&mut self) {
        self.channel.close();
    }
}

impl State {
    fn handle(&mut self, message: ToRecorder) {
        match &message {
            ToRecorder::Show(window) => self.window = Some(*window),
            ToRecorder::Filter(_) | ToRecorder::SetLanguage { .. } => self.generation += 1,
            ToRecorder::Clear => {
                self.generation += 1;
                self.cleared = std::mem::take(&mut self.rows);
                self.gone = 0;
            }
            ToRecorder::EndClear { undo: true } => {
                self.generation += 1;
                self.rows = std::mem::take(&mut self.cleared);
            }
            _ => {}
        }
        self.received.push(message);
    }

    fn page(&self) -> Option<LogPage> {
        let window = self.window?;
        let rows = usize::from(window.rows);
        let end = self.rows.len();
        let first = window.first.map_or(end.saturating_sub(rows), |first| {
            usize::try_from(first).unwrap()
        });
        let first = first.clamp(self.gone, end);
        let behind = (first + rows).min(end);
        Some(LogPage {
            oldest: self.gone as u64,
            end: end as u64,
            kept: (end - self.gone) as u64,
            gone: self.gone as u64,
            collapsed: 0,
            filtered_per_mille: 1000,
            generation: self.generation,
            rows: self.rows[first..behind].to_vec(),
        })
    }
}

fn row(number: usize, kind: Kind) -> Row {
    Row {
        number: number as u64,
        kind,
        time: "13:15:36.962".to_owned(),
        id: "0x01".to_owned(),
        hex: "01 64 00 64 00 00 01 00 00 A1".to_owned(),
        meaning: format!("frame {number}"),
        collapsed_before: 0,
        opened: 0,
    }
}

fn post(channel: &BroadcastChannel, message: &FromRecorder, file: Option<&Blob>) {
    let bytes = Uint8Array::from(encode(message).unwrap().as_slice());
    let posted = match file {
        None => channel.post_message(&bytes),
        Some(file) => channel.post_message(&Array::of2(&bytes, file)),
    };
    posted.unwrap();
}
