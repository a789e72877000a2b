//! The bytes of an open file.

use std::ops::Range;

use js_sys::Uint8Array;
use wasm_bindgen::JsValue;
use wasm_bindgen_futures::JsFuture;
use web_sys::Blob;

/// A file of the user, or a session made of a CSV file.
#[derive(Clone, Debug)]
pub(super) struct Source(Blob);

impl Source {
    pub(super) const fn new(file: Blob) -> Self {
        Self(file)
    }

    /// Its length in bytes.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and sizes are positive"
    )]
    pub(super) fn len(&self) -> u64 {
        self.0.size() as u64
    }

    /// Reads these bytes.
    #[allow(
        clippy::cast_precision_loss,
        reason = "no file is so long that a double does not count its bytes"
    )]
    pub(super) async fn read(&self, range: Range<u64>) -> Result<Vec<u8>, JsValue> {
        let slice = self
            .0
            .slice_with_f64_and_f64(range.start as f64, range.end as f64)?;
        let bytes = JsFuture::from(slice.array_buffer()).await?;
        Ok(Uint8Array::new(&bytes).to_vec())
    }
}
