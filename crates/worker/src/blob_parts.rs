//! Files as blobs of the browser: outside of our memory, and on disk if they are large.

use js_sys::{Array, Uint8Array};
use wasm_bindgen::JsValue;
use web_sys::{Blob, BlobPropertyBag};

use crate::scope::{global, report};

/// The media type of CSV: RFC 7111.
pub(crate) const CSV: &str = "text/csv;charset=utf-8";

/// The parts of the file that is being written, each a `Blob`.
#[derive(Debug, Default)]
pub(crate) struct Parts(Array);

impl Parts {
    pub(crate) fn push(&mut self, bytes: &[u8]) {
        let bytes = Array::of1(&Uint8Array::from(bytes));
        match Blob::new_with_u8_array_sequence(&bytes) {
            Ok(part) => _ = self.0.push(&part),
            Err(error) => report("a part of a file could not be stored", &error),
        }
    }

    pub(crate) fn clear(&mut self) {
        self.0 = Array::new();
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
        let file = Blob::new_with_blob_sequence_and_options(&self.0, &options);
        self.clear();
        file
    }
}

#[cfg(test)]
mod tests {
    use wasm_bindgen_futures::JsFuture;
    use wasm_bindgen_test::wasm_bindgen_test;

    use super::*;

    #[wasm_bindgen_test]
    async fn a_file_is_its_parts_in_order_and_the_next_starts_empty() {
        let mut parts = Parts::default();
        parts.push(b"given up");
        parts.clear();
        parts.push(b"time,id\r\n");
        parts.push("66.96°\r\n".as_bytes());
        let file = parts.take_file(CSV).unwrap();
        let text = JsFuture::from(file.text()).await.unwrap();
        assert_eq!(text.as_string().unwrap(), "time,id\r\n66.96°\r\n");
        assert_eq!(file.type_(), CSV);
        assert!(parts.take_file(CSV).unwrap().size() < 1.0);
    }
}
