//! Closures of a view with their types forgotten.
//!
//! A view makes its code anew for the type of each closure in it, and every closure has a type of
//! its own. Boxed, all that give a `String` share one: 20 KB less of the page's gzip.

use leptos::prelude::{Effect, Memo};

/// What a part of the view shows, read anew whenever it changes.
pub(crate) fn live<T>(read: impl FnMut() -> T + Send + 'static) -> Box<dyn FnMut() -> T + Send> {
    Box::new(read)
}

/// Does this now, and again whenever something changes that it has read: effects too share their code
/// this way.
pub(crate) fn follow(act: impl FnMut() + 'static) {
    follow_boxed(Box::new(act));
}

fn follow_boxed(mut act: Box<dyn FnMut()>) {
    Effect::new(move |_| act());
}

/// A value that others read, made anew when something changes that it was made of; those others only
/// hear of it where it differs. All of one type share their code.
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

/// What is done when an event is heard.
pub(crate) fn heard<E>(act: impl FnMut(E) + 'static) -> Box<dyn FnMut(E)> {
    Box::new(act)
}
