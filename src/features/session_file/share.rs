//! The saved session for another app, through the share dialog of the system (Web Share API). Few desktop browsers have
//! it; there is no button without it.

use js_sys::{Array, Function, Object, Promise, Reflect};
use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use web_sys::DomException;

use super::incoming::member;

/// The file that was saved last, where the browser can share it.
#[derive(Clone, Copy)]
pub(super) struct Shareable {
    /// Ready before the press: a browser opens the dialog only at once.
    file: RwSignal<Option<JsValue>, LocalStorage>,
    /// Whether this browser refuses the ending of a session. Chromium shares only files with an ending that it knows
    /// (`kPermitted` in its `share_service_impl.cc`).
    as_text: StoredValue<bool>,
}

impl Shareable {
    pub(super) fn new() -> Self {
        Self {
            file: RwSignal::new_local(None),
            as_text: StoredValue::new(false),
        }
    }

    /// Whether there is a file to share.
    pub(super) fn is_ready(self) -> bool {
        self.file.with(Option::is_some)
    }

    /// Offers no file: another one is being saved.
    pub(super) fn forget(self) {
        self.file.set(None);
    }

    /// Offers a file that was saved: its content, or the handle of the file that it was written to.
    pub(super) fn offer(self, content: JsValue) {
        spawn_local(async move {
            let file = match member(&content, "getFile").dyn_into::<Function>() {
                Ok(read) => {
                    let Ok(reading) = read.call0(&content) else {
                        return;
                    };
                    match JsFuture::from(reading.unchecked_into::<Promise>()).await {
                        Ok(file) => file,
                        // It was moved or deleted meanwhile.
                        Err(_) => return,
                    }
                }
                Err(_) => content,
            };
            if can_share(&file).unwrap_or(false) {
                // Nothing if the page was closed meanwhile.
                let _ = self.file.try_set(Some(file));
            }
        });
    }

    /// Opens the share dialog for the file, under this name. `say` shows the result: whether it is an error, and a text.
    pub(super) fn share(self, saved_as: String, say: impl Fn(bool, String) + 'static) {
        let Some(file) = self.file.get_untracked() else {
            return;
        };
        let as_text = self.as_text.get_value();
        let (name, kind) = if as_text {
            (saved_as + ".txt", "text/plain")
        } else {
            (saved_as, "application/octet-stream")
        };
        let shared = named(&file, &name, kind).and_then(|file| {
            let (navigator, what) = (navigator(), files(&file)?);
            let share = member(&navigator, "share").dyn_into::<Function>()?;
            share.call1(&navigator, &what)
        });
        spawn_local(async move {
            let shared = match shared {
                Ok(dialog) => JsFuture::from(dialog.unchecked_into::<Promise>()).await,
                Err(error) => Err(error),
            };
            let Err(error) = shared else {
                return say(false, tr!("Shared {name}", name));
            };
            let error = error.dyn_ref::<DomException>().map(DomException::name);
            match error.as_deref() {
                Some("AbortError") => say(false, tr!("Not shared").to_owned()),
                Some("NotAllowedError") if !as_text => {
                    let _ = self.as_text.try_update_value(|as_text| *as_text = true);
                    say(
                        true,
                        tr!(
                            "Not shared: this browser refuses .mcap files. Press Share again to share it as {name}.txt, which MotorLink opens too.",
                            name
                        ),
                    );
                }
                _ => say(
                    true,
                    tr!("Not shared: the browser refused. Send the saved file another way.")
                        .to_owned(),
                ),
            }
        });
    }
}

fn can_share(file: &JsValue) -> Result<bool, JsValue> {
    let navigator = navigator();
    let can = member(&navigator, "canShare").dyn_into::<Function>()?;
    // By the name under which it may be shared at last.
    let file = named(file, "session.mcap.txt", "text/plain")?;
    Ok(can.call1(&navigator, &files(&file)?)?.is_truthy())
}

/// `{ files: [file] }`
fn files(file: &JsValue) -> Result<JsValue, JsValue> {
    let what = Object::new();
    Reflect::set(&what, &"files".into(), &Array::of1(file))?;
    Ok(what.into())
}

/// The same content as a file of this name.
fn named(content: &JsValue, name: &str, kind: &str) -> Result<JsValue, JsValue> {
    let options = Object::new();
    Reflect::set(&options, &"type".into(), &kind.into())?;
    let class = member(&window(), "File").dyn_into::<Function>()?;
    let arguments = Array::of3(&Array::of1(content), &name.into(), &options);
    Reflect::construct(&class, &arguments)
}

fn navigator() -> JsValue {
    window().navigator().into()
}
