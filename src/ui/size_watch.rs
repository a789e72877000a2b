//! Watches the size of an element.

use wasm_bindgen::{JsCast, prelude::Closure};
use web_sys::{Element, ResizeObserver};

/// Reports the size of an element, now and after changes. Dropping it ends that.
pub(crate) struct SizeWatch {
    observer: ResizeObserver,
    _on_size: Closure<dyn FnMut()>,
}

impl SizeWatch {
    pub(crate) fn of(element: &Element, on_size: impl FnMut() + 'static) -> Option<Self> {
        let on_size = Closure::<dyn FnMut()>::new(on_size);
        let observer = ResizeObserver::new(on_size.as_ref().unchecked_ref()).ok()?;
        observer.observe(element);
        Some(Self {
            observer,
            _on_size: on_size,
        })
    }
}

impl Drop for SizeWatch {
    fn drop(&mut self) {
        self.observer.disconnect();
    }
}
