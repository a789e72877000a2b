//! The setup as a link: copied here, and offered with a question to the page that opens it.
//!
//! A link changes nothing by itself: nobody can raise a limit unseen by sending one.
//!
//! | file | idea |
//! |---|---|
//! | `address` | opens the panel if the address has a setup |
//! | `panel` | the panel `Setup link` |
//! | `changes` | what a setup would change |
//! | `encoding` | a setup as text for an address |

pub(crate) mod address;
mod changes;
mod encoding;
pub(crate) mod panel;
