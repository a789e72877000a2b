//! The browser's private file system (OPFS): directories, and files that one worker at a time can open.

use js_sys::{AsyncIterator, Promise, Reflect, Uint8Array};
use motorlink_messages::recorder::NotSaved;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    DomException, File, FileSystemDirectoryHandle, FileSystemFileHandle,
    FileSystemGetDirectoryOptions, FileSystemGetFileOptions, FileSystemReadWriteOptions,
    FileSystemRemoveOptions, FileSystemSyncAccessHandle,
};

use crate::scope::global;

/// The directory of the sessions in the file system of this page's origin.
const SESSIONS: &str = "motorlink-sessions";

/// The browser's file system failed.
pub(super) type Result<T> = std::result::Result<T, JsValue>;

/// A directory.
#[derive(Clone, Debug)]
pub(super) struct Dir(FileSystemDirectoryHandle);

impl Dir {
    /// The directory of all sessions; `None` in a browser without such a file system.
    pub(super) async fn of_sessions() -> Option<Self> {
        let there = |object: &JsValue, name: &str| Reflect::has(object, &name.into()).ok();
        let navigator = global().navigator();
        let has_handles = there(&global(), "FileSystemSyncAccessHandle")?;
        if !has_handles || !there(&navigator, "storage")? {
            return None;
        }
        let storage = navigator.storage();
        if !there(&storage, "getDirectory")? {
            return None;
        }
        let root = Self(awaited(storage.get_directory()).await.ok()?);
        root.dir(SESSIONS).await.ok()
    }

    /// Opens the subdirectory of this name, and creates it if necessary.
    pub(super) async fn dir(&self, name: &str) -> Result<Self> {
        let options = FileSystemGetDirectoryOptions::new();
        options.set_create(true);
        let dir = self.0.get_directory_handle_with_options(name, &options);
        awaited(dir).await.map(Self)
    }

    /// The names of its entries.
    pub(super) async fn names(&self) -> Result<Vec<String>> {
        let keys: AsyncIterator = self.0.keys();
        let mut names = Vec::new();
        loop {
            let next = JsFuture::from(keys.next()?).await?;
            if Reflect::get(&next, &"done".into())?.is_truthy() {
                return Ok(names);
            }
            let name = Reflect::get(&next, &"value".into())?;
            names.extend(name.as_string());
        }
    }

    /// Removes a file, or a directory with its content. Succeeds if there is none.
    pub(super) async fn remove(&self, name: &str) -> Result<()> {
        let options = FileSystemRemoveOptions::new();
        options.set_recursive(true);
        let removed = JsFuture::from(self.0.remove_entry_with_options(name, &options)).await;
        match removed {
            Err(error) if name_of(&error) != "NotFoundError" => Err(error),
            _ => Ok(()),
        }
    }

    /// Opens a file, and creates it if necessary. Fails if it is already open, here or in another tab.
    pub(super) async fn open(&self, name: &str) -> Result<OpenFile> {
        let options = FileSystemGetFileOptions::new();
        options.set_create(true);
        let file = self.0.get_file_handle_with_options(name, &options);
        let file: FileSystemFileHandle = awaited(file).await?;
        awaited(file.create_sync_access_handle())
            .await
            .map(OpenFile)
    }

    /// The size of a file in bytes.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float cast saturates, and sizes are positive"
    )]
    pub(super) async fn size(&self, name: &str) -> Result<usize> {
        Ok(self.file(name).await?.size() as usize)
    }

    /// The content of a file.
    pub(super) async fn read(&self, name: &str) -> Result<Vec<u8>> {
        let bytes = JsFuture::from(self.file(name).await?.array_buffer()).await?;
        Ok(Uint8Array::new(&bytes).to_vec())
    }

    async fn file(&self, name: &str) -> Result<File> {
        let file: FileSystemFileHandle = awaited(self.0.get_file_handle(name)).await?;
        awaited(file.get_file()).await
    }
}

/// An open file. No other tab or worker can open it until this is dropped or the worker ends.
#[derive(Debug)]
pub(super) struct OpenFile(FileSystemSyncAccessHandle);

impl OpenFile {
    /// Appends bytes.
    #[allow(clippy::cast_precision_loss, reason = "a few megabytes")]
    pub(super) fn append(&self, bytes: &[u8]) -> Result<()> {
        let options = FileSystemReadWriteOptions::new();
        options.set_at(self.0.get_size()?);
        let written = self
            .0
            .write_with_js_u8_array_and_options(&Uint8Array::from(bytes), &options)?;
        if written < bytes.len() as f64 {
            // Some browsers do not throw when the disk is full, but write less.
            return Err(DomException::new_with_message_and_name("", NO_ROOM)?.into());
        }
        Ok(())
    }

    /// Flushes it, so that it survives a power cut.
    pub(super) fn flush(&self) -> Result<()> {
        self.0.flush()
    }
}

impl Drop for OpenFile {
    fn drop(&mut self) {
        self.0.close();
    }
}

const NO_ROOM: &str = "QuotaExceededError";

/// The reason of a failure, for the page.
pub(super) fn why(error: &JsValue) -> NotSaved {
    if name_of(error) == NO_ROOM {
        NotSaved::NoRoom
    } else {
        NotSaved::Failed
    }
}

fn name_of(error: &JsValue) -> String {
    let error = error.dyn_ref::<DomException>();
    error.map(DomException::name).unwrap_or_default()
}

/// Awaits a promise. The caller chooses the type that the browser documents.
async fn awaited<T: JsCast>(promise: Promise) -> Result<T> {
    Ok(JsFuture::from(promise).await?.unchecked_into())
}
