//! Setting up the wheels of a rover: one motor after the other gets its ID, then each wheel is checked.
//!
//! | file | idea |
//! |---|---|
//! | `wheel` | the wheels, their defaults, and the checks of what is entered |
//! | `state`, `spin` | the steps, the activity that runs in a step, and its outcome |
//! | `stored` | the progress as text; the browser stores it after every change |
//! | `actions` | commands to the bus, the timer of a spin, and the stored names and sides |
//! | `panel` | the panel, and the actions of its controls |
//! | `markup`, `rows`, `texts` | the HTML of each step, its lists, and the messages |

pub(crate) mod actions;
pub(crate) mod markup;
pub(crate) mod panel;
pub(crate) mod rows;
pub(crate) mod spin;
pub(crate) mod state;
pub(crate) mod stored;
pub(crate) mod texts;
pub(crate) mod wheel;
