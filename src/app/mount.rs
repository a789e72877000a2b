//! Mounting one section of the page.

use std::any::Any;

use leptos::{prelude::*, tachys::view::Mountable};
use web_sys::HtmlElement;

/// Keeps a section mounted.
pub(crate) type Mounted = (Owner, Box<dyn Any>);

/// Mounts a section after the existing content of the place.
pub(crate) fn mount<V: IntoView + 'static>(
    place: &HtmlElement,
    section: impl FnOnce() -> V + 'static,
) -> Mounted {
    let place = place.clone();
    let build = move || -> Box<dyn Any> {
        let mut view = section().into_view().build();
        view.mount(&place, None);
        Box::new(view)
    };
    mount_boxed(Box::new(build))
}

/// All sections share this code.
fn mount_boxed(build: Box<dyn FnOnce() -> Box<dyn Any>>) -> Mounted {
    let owner = Owner::new();
    let view = owner.with(build);
    (owner, view)
}

/// Where the sections of a part are mounted, in the order of the sections.
pub(crate) struct Hosts {
    /// The owner of the page, with the contexts of the sections.
    pub(crate) owner: Owner,
    pub(crate) elements: Vec<HtmlElement>,
}

impl Hosts {
    /// Mounts the next section in place of its placeholder.
    pub(crate) fn mount<V: IntoView + 'static>(
        &mut self,
        section: impl FnOnce() -> V + 'static,
    ) -> Option<Mounted> {
        if self.elements.is_empty() {
            return None;
        }
        let host = self.elements.remove(0);
        host.set_text_content(None);
        Some(self.owner.with(|| mount(&host, section)))
    }
}
