//! What lies in the drawer: a panel over the right of the desk, while a person wants it.

/// A panel of the drawer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Drawer {
    /// How well the line works, and what is wrong with it.
    Link,
    /// Several motors as one.
    Together,
    /// Limits, the setup as a file, and what is kept.
    Settings,
}
