//! The runs of experiments. Their program is loaded into the thread of the port worker, with a memory of its own.
//!
//! | file | what it holds |
//! |---|---|
//! | `host` | the side of the port worker |
//! | `loading` | loads the program with the first message |
//! | `program` | the side of the program |

pub(crate) mod host;
pub(crate) mod loading;
pub(crate) mod program;
