//! The file that is written: on disk, or in memory of the browser for a download.

use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::{DomException, FileSystemFileHandle, FileSystemWritableFileStream};

use motorlink_messages::sessions::NotSaved;

use crate::blob_parts::Parts;

/// A file that is written from its start.
#[derive(Debug)]
pub(super) enum Target {
    /// The file that the user has chosen. It is replaced when it is complete.
    Disk(FileSystemWritableFileStream),
    /// A download, when it is complete.
    Download(Parts),
}

impl Target {
    /// The file of this handle, or a download without one.
    pub(super) async fn open(handle: Option<FileSystemFileHandle>) -> Result<Self, NotSaved> {
        let Some(handle) = handle else {
            return Ok(Self::Download(Parts::default()));
        };
        let stream = JsFuture::from(handle.create_writable()).await;
        let stream = stream.map_err(|error| reason(&error))?;
        Ok(Self::Disk(stream.unchecked_into()))
    }

    /// Appends bytes.
    pub(super) async fn write(&mut self, bytes: &[u8]) -> Result<(), NotSaved> {
        match self {
            Self::Disk(stream) => {
                let written = stream.write_with_u8_array(bytes);
                let written = written.map_err(|error| reason(&error))?;
                JsFuture::from(written)
                    .await
                    .map_err(|error| reason(&error))?;
            }
            Self::Download(parts) => parts.push(bytes).map_err(|_| NotSaved::NoRoom)?,
        }
        Ok(())
    }

    /// Discards what was written.
    pub(super) async fn discard(self) {
        if let Self::Disk(stream) = self {
            // The file is given up: nothing can be done about a failure.
            let _ = JsFuture::from(stream.abort()).await;
        }
    }

    /// Completes it. Returns the parts of a download.
    pub(super) async fn complete(self) -> Result<Option<Parts>, NotSaved> {
        match self {
            Self::Disk(stream) => {
                let closed = JsFuture::from(stream.close()).await;
                closed.map(|_| None).map_err(|error| reason(&error))
            }
            Self::Download(parts) => Ok(Some(parts)),
        }
    }
}

fn reason(error: &JsValue) -> NotSaved {
    let name = error.dyn_ref::<DomException>().map(DomException::name);
    match name.as_deref() {
        Some("QuotaExceededError") => NotSaved::NoRoom,
        _ => NotSaved::Failed,
    }
}
