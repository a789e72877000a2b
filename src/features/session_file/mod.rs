//! Session files: saves what the recorder keeps, and opens such files.
//!
//! | file | idea |
//! |---|---|
//! | `incoming` | files that are dropped onto the page, or opened with the installed app |
//! | `actions` | what the buttons do, and the messages of the session worker |
//! | `save_range` | the choice of how much is saved |
//! | `readiness` | whether there is anything to save |
//! | `save_picker` | the browser's dialog for a file to write |
//! | `player` | shows an open file as if it were the live line |
//! | `player/gate` | which messages cross between the recording and the live line |
//! | `player/controls` | what the controls of the replay do |
//! | `replay_bar` | the controls of the replay |
//! | `bookmarks` | the bookmarks of the open file |
//! | `bookmark_form` | the note of a bookmark, in the controls of the replay |
//! | `texts` | the texts of the panel and the replay |
//! | `panel` | the panel `Session file` |
//! | `content` | what is in an open file |
//! | `events` | the list of events and bookmarks |
//! | `timeline` | the whole session in one picture |

pub(crate) mod actions;
mod bookmark_form;
mod bookmarks;
mod content;
mod events;
pub(crate) mod incoming;
pub(crate) mod panel;
pub(crate) mod player;
mod readiness;
mod replay_bar;
mod save_picker;
mod save_range;
mod texts;
mod timeline;
