//! From the recorder to a session file.
//!
//! The worker requests the next part when it has written the one before, so at most one part waits. Between two parts
//! it receives messages, such as the one that cancels.

use js_sys::{Promise, Uint8Array};
use motorlink_messages::{
    decode,
    sessions::{FromSessions, Kept, KeptRecord, NotSaved, RunsSaved, SaveRange},
};
use motorlink_session::{Event, RunEvents, Writer};
use wasm_bindgen::JsCast;
use wasm_bindgen_futures::JsFuture;
use web_sys::{FileSystemFileHandle, MessageEvent, MessagePort};

use super::{
    runs,
    state::{Reporter, Shared, post, post_file},
    target::Target,
};
use crate::recorder_request::RecorderRequest;

/// Bytes per write: a chunk of the file.
const PIECE: usize = 256 << 10;

/// The name of the attached setup.
pub(super) const SETUP: &str = "setup.json";

/// The media type of MCAP files, which is not registered.
pub(super) const MCAP: &str = "application/octet-stream";

/// What is saved.
pub(super) struct SaveOrder {
    /// The version of the page.
    pub(super) version: String,
    /// The setup as JSON.
    pub(super) setup: String,
    /// The rover as JSON; empty if the setup has none.
    pub(super) rover: String,
    /// How much of what is kept.
    pub(super) range: SaveRange,
}

/// Saves what the recorder keeps, and posts the outcome.
pub(super) async fn save(
    shared: &Shared,
    recorder: MessagePort,
    handle: Option<FileSystemFileHandle>,
    order: &SaveOrder,
) {
    let kept = KeptParts {
        shared: shared.clone(),
        port: recorder,
    };
    let outcome = write(&kept, handle, order).await;
    kept.port.close();
    {
        let worker = &mut *shared.borrow_mut();
        worker.is_saving = false;
        worker.wake = None;
    }
    if let Err(reason) = outcome {
        post(&FromSessions::NotSaved(reason));
    }
}

/// What the recorder keeps, part by part.
struct KeptParts {
    shared: Shared,
    port: MessagePort,
}

impl KeptParts {
    async fn request(&self, part: RecorderRequest) -> Result<Kept, NotSaved> {
        if !self.shared.borrow().is_saving {
            return Err(NotSaved::Cancelled);
        }
        let answer = Promise::new(&mut |resolve, _| {
            self.port.set_onmessage(Some(&resolve));
            self.shared.borrow_mut().wake = Some(resolve);
        });
        let posted = self.port.post_message(&part.message());
        posted.map_err(|_| NotSaved::NoRecorder)?;
        let answer = JsFuture::from(answer).await.ok();
        let event = answer.and_then(|answer| answer.dyn_into::<MessageEvent>().ok());
        // Without a message it was woken.
        let event = event.ok_or(NotSaved::Cancelled)?;
        let bytes = Uint8Array::new(&event.data()).to_vec();
        decode(&bytes).map_err(|_| NotSaved::NoRecorder)
    }
}

async fn write(
    kept: &KeptParts,
    handle: Option<FileSystemFileHandle>,
    order: &SaveOrder,
) -> Result<(), NotSaved> {
    let mut part = kept.request(RecorderRequest::First(order.range)).await?;
    if let Kept::Part {
        records,
        is_last: true,
        ..
    } = &part
        && records.is_empty()
    {
        return Err(NotSaved::Nothing);
    }
    let mut target = Target::open(handle).await?;
    match write_to(kept, &mut part, &mut target, order).await {
        Ok(message) => {
            if let Some(mut parts) = target.complete().await? {
                return post_file(&message, &mut parts, MCAP).map_err(|_| NotSaved::NoRoom);
            }
            post(&message);
            Ok(())
        }
        Err(reason) => {
            target.discard().await;
            Err(reason)
        }
    }
}

/// Writes the whole file. Returns the message about it.
async fn write_to(
    kept: &KeptParts,
    part: &mut Kept,
    target: &mut Target,
    order: &SaveOrder,
) -> Result<FromSessions, NotSaved> {
    let mut reporter = Reporter::new(&kept.shared, FromSessions::Saving);
    let mut writer: Option<Writer> = None;
    let mut run_events = RunEvents::default();
    let (mut bytes, mut records) = (0, 0);
    loop {
        let (zero_us, progress, slice, is_last) = match std::mem::replace(part, Kept::Changed) {
            Kept::Part {
                zero_us,
                progress,
                records,
                is_last,
            } => (zero_us, progress, records, is_last),
            Kept::Restoring => return Err(NotSaved::Restoring),
            Kept::Changed => return Err(NotSaved::Changed),
        };
        let about = [
            ("page", order.version.as_str()),
            ("rover", order.rover.as_str()),
        ];
        let known = about.split_at(2 - usize::from(order.rover.is_empty())).0;
        let writer = writer.get_or_insert_with(|| Writer::new(zero_us, known));
        for record in slice {
            records += u64::from(!matches!(record, KeptRecord::State { .. }));
            match record {
                KeptRecord::Line(event) => writer.line(&event),
                KeptRecord::State { at, stored } => writer.state(at, &stored),
                KeptRecord::Message { at, error, text } => {
                    let event = Event::of_page(&text, error);
                    run_events.add(at, zero_us, &event);
                    writer.event(at, &event);
                }
            }
        }
        if writer.written() >= PIECE {
            let piece = writer.take();
            bytes += piece.len() as u64;
            target.write(&piece).await?;
        }
        reporter.report(progress.done, progress.of);
        if is_last {
            break;
        }
        *part = kept.request(RecorderRequest::Next).await?;
    }
    let mut runs = RunsSaved::default();
    if let Some(mut writer) = writer {
        writer.attach(SETUP, "application/json", order.setup.as_bytes());
        runs = runs::attach(&run_events, async |header, record| {
            if !kept.shared.borrow().is_saving {
                return Err(NotSaved::Cancelled);
            }
            writer.attach_run(header, record);
            let piece = writer.take();
            bytes += piece.len() as u64;
            target.write(&piece).await
        })
        .await?;
        let rest = writer.finish();
        bytes += rest.len() as u64;
        target.write(&rest).await?;
    }
    Ok(FromSessions::Saved {
        bytes,
        records,
        runs,
    })
}
