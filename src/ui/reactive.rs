//! Boxed closures for views, effects and event handlers.
//!
//! Leptos compiles its code once per closure type, and every closure is its own type. Boxed closures with the same
//! signature share one type, which saves 20 KB of the page's gzip.

use leptos::prelude::{Effect, Memo};

/// A dynamic text or attribute of a view: evaluated again whenever a signal in it changes.
pub(crate) fn dynamic<T>(read: impl FnMut() -> T + Send + 'static) -> Box<dyn FnMut() -> T + Send> {
    Box::new(read)
}

/// Runs `run` now, and again whenever a signal that it has read changes.
pub(crate) fn effect(run: impl FnMut() + 'static) {
    effect_boxed(Box::new(run));
}

fn effect_boxed(mut run: Box<dyn FnMut()>) {
    Effect::new(move |_| run());
}

/// A derived value: computed again when a signal in it changes. Its readers run only if the value differs.
pub(crate) fn memo<T: PartialEq + Send + Sync + 'static>(
    read: impl Fn() -> T + Send + Sync + 'static,
) -> Memo<T> {
    memo_boxed(Box::new(read))
}

fn memo_boxed<T: PartialEq + Send + Sync + 'static>(
    read: Box<dyn Fn() -> T + Send + Sync>,
) -> Memo<T> {
    Memo::new(move |_| read())
}

/// A handler of a DOM event.
pub(crate) fn handler<E>(handle: impl FnMut(E) + 'static) -> Box<dyn FnMut(E)> {
    Box::new(handle)
}
