//! The setup and the view as a link: copied here. The page that opens it shows the view, and asks before it applies the
//! setup.
//!
//! A link changes no setting by itself: nobody can raise a limit unseen by sending one.
//!
//! | file | idea |
//! |---|---|
//! | `address` | opens the panel if the address has a setup |
//! | `panel` | the panel `Setup link` |
//! | `changes` | what a setup would change |
//! | `encoding` | a setup as text for an address |
//! | `view` | what the page shows, as text for an address |

pub(crate) mod address;
mod changes;
mod encoding;
pub(crate) mod panel;
mod view;
