//! Files as blobs of the browser: outside of our memory, and on disk if they are large.

use js_sys::{Array, Uint8Array};
use wasm_bindgen::JsValue;
use web_sys::{Blob, BlobPropertyBag};

use crate::scope::global;

/// The media type of CSV: RFC 7111.
pub(crate) const CSV: &str = "text/csv;charset=utf-8";

/// The parts of the file that is being written, each a `Blob`.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    parts: Array,
    /// Why a part could not be stored. Without it, there is no file.
    lacks: Option<JsValue>,
}

impl Parts {
    /// Appends a part.
    ///
    /// # Errors
    /// The browser has no room for it. [`Self::take_file`] then fails too.
    pub(crate) fn push(&mut self, bytes: &[u8]) -> Result<(), JsValue> {
        let bytes = Array::of1(&Uint8Array::from(bytes));
        match Blob::new_with_u8_array_sequence(&bytes) {
            Ok(part) => _ = self.parts.push(&part),
            Err(error) => {
                self.lacks = Some(error.clone());
                return Err(error);
            }
        }
        Ok(())
    }

    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Posts the file to the page, with the message that names it.
    pub(crate) fn post_as_file(&mut self, message: &[u8], media_type: &str) -> Result<(), JsValue> {
        let file = self.take_file(media_type)?;
        global().post_message(&Array::of2(&Uint8Array::from(message), &file))
    }

    /// The file. The next one starts empty.
    pub(crate) fn take_file(&mut self, media_type: &str) -> Result<Blob, JsValue> {
        let options = BlobPropertyBag::new();
        options.set_type(media_type);
        let Self { parts, lacks } = std::mem::take(self);
        match lacks {
            Some(error) => Err(error),
            None => Blob::new_with_blob_sequence_and_options(&parts, &options),
        }
    }
}

#[cfg(test)]
mod tests {
    use js_sys::Function;
    use wasm_bindgen_futures::JsFuture;
    use wasm_bindgen_test::wasm_bindgen_test;

    use super::*;

    #[wasm_bindgen_test]
    async fn a_file_is_its_parts_in_order_and_the_next_starts_empty() {
        let mut parts = Parts::default();
        parts.push(b"given up").unwrap();
        parts.clear();
        parts.push(b"time,id\r\n").unwrap();
        parts.push("66.96°\r\n".as_bytes()).unwrap();
        let file = parts.take_file(CSV).unwrap();
        let text = JsFuture::from(file.text()).await.unwrap();
        assert_eq!(text.as_string().unwrap(), "time,id\r\n66.96°\r\n");
        assert_eq!(file.type_(), CSV);
        assert!(parts.take_file(CSV).unwrap().size() < 1.0);
    }

    #[wasm_bindgen_test]
    fn there_is_no_file_without_one_of_its_parts() {
        let run = |script| Function::new_no_args(script).call0(&JsValue::UNDEFINED);
        let mut parts = Parts::default();
        parts.push(b"time,id\r\n").unwrap();
        run("globalThis.WholeBlob = Blob; Blob = class { constructor() { throw new Error('no room'); } }")
            .unwrap();
        let pushed = parts.push(b"1,2\r\n");
        run("Blob = WholeBlob").unwrap();
        assert!(pushed.is_err());
        assert!(parts.take_file(CSV).is_err());
        parts.push(b"the next one").unwrap();
        assert!(parts.take_file(CSV).is_ok());
    }
}
