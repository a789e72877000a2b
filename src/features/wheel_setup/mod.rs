//! Setting up the wheels of a rover: one motor after the other gets its ID, then each wheel is checked.
//!
//! | file | idea |
//! |---|---|
//! | `wheel` | the wheels that are entered, their defaults, and what is wrong with them |
//! | `state`, `spin` | the steps, and what is done in one of them |
//! | `stored` | the progress as text, which the browser stores after every step |
//! | `actions` | commands, the half second of a spin, names and sides of the page |
//! | `panel` | the panel, and what its controls do |
//! | `markup`, `rows`, `texts` | what each step shows, its lists, and the messages |

pub(crate) mod actions;
pub(crate) mod markup;
pub(crate) mod panel;
pub(crate) mod rows;
pub(crate) mod spin;
pub(crate) mod state;
pub(crate) mod stored;
pub(crate) mod texts;
pub(crate) mod wheel;
