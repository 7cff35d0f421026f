//! The error type of all crates: what went wrong, where in which input, and with which exit code.

use std::fmt;
use std::io;

/// Result of every fallible operation of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// The kind of a failure; each kind has its own exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// Reading, writing or running failed (exit 1).
    Io,
    /// The request is invalid: flags, or inputs that do not fit together (exit 2).
    Usage,
    /// The input is malformed, truncated, or contradicts itself (exit 3).
    Malformed,
    /// An audit found a violation (exit 4).
    Audit,
    /// The memory budget is too small (exit 5).
    Memory,
    /// The input needs what this program does not know, because another version of
    /// spmesh made it (exit 6).
    Unsupported,
    /// The result is complete but for points of inputs that were cut off (exit 7).
    Salvaged,
    /// The reader of the output closed the pipe (exit 141, without a message).
    ClosedPipe,
}

impl ErrorKind {
    /// Process exit code of this kind of failure.
    pub fn exit_code(self) -> u8 {
        match self {
            ErrorKind::Io => 1,
            ErrorKind::Usage => 2,
            ErrorKind::Malformed => 3,
            ErrorKind::Audit => 4,
            ErrorKind::Memory => 5,
            ErrorKind::Unsupported => 6,
            ErrorKind::Salvaged => 7,
            ErrorKind::ClosedPipe => 141,
        }
    }
}

/// A failure with its kind, its input, its position there if it has one, and a message that states what was
/// found and what was expected.
#[derive(Debug)]
pub struct Error {
    kind: ErrorKind,
    input: Option<String>,
    position: Option<String>,
    message: String,
    cause: Option<io::Error>,
}

impl Error {
    /// An error of `kind`; [`Error::at`] and [`Error::of_input`] add where it happened.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Error { kind, input: None, position: None, message: message.into(), cause: None }
    }

    /// An invalid request.
    pub fn usage(message: impl Into<String>) -> Self {
        Error::new(ErrorKind::Usage, message)
    }

    /// Input that is malformed, truncated, or contradicts itself.
    pub fn malformed(message: impl Into<String>) -> Self {
        Error::new(ErrorKind::Malformed, message)
    }

    /// Input that needs what this program does not know, such as a newer version of a format.
    pub fn unsupported(message: impl Into<String>) -> Self {
        Error::new(ErrorKind::Unsupported, message)
    }

    /// A failure of the operating system during `what` ("reading", "creating the temporary file").
    ///
    /// A broken pipe becomes [`ErrorKind::ClosedPipe`]; an unexpected end of file and invalid data become
    /// [`ErrorKind::Malformed`]. An error of this type inside of `cause`, such as that of a part of a mesh
    /// that is read as one stream, is returned as it is.
    pub fn io(what: impl Into<String>, cause: io::Error) -> Self {
        let cause = match cause.downcast::<Error>() {
            Ok(inner) => return inner,
            Err(cause) => cause,
        };
        let kind = match cause.kind() {
            io::ErrorKind::BrokenPipe => ErrorKind::ClosedPipe,
            io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidData => ErrorKind::Malformed,
            _ => ErrorKind::Io,
        };
        Error { kind, input: None, position: None, message: what.into(), cause: Some(cause) }
    }

    /// A computation on points or lines that was refused, by a crate that knows nothing of inputs and exit
    /// codes. Too much of a request is [`ErrorKind::Usage`], malformed data are [`ErrorKind::Malformed`], and a
    /// budget that is exceeded is [`ErrorKind::Memory`].
    pub fn of_computation(cause: impl Into<io::Error>) -> Self {
        let cause = cause.into();
        let kind = match cause.kind() {
            io::ErrorKind::InvalidInput => ErrorKind::Usage,
            io::ErrorKind::InvalidData => ErrorKind::Malformed,
            io::ErrorKind::OutOfMemory => ErrorKind::Memory,
            _ => ErrorKind::Io,
        };
        Error::new(kind, cause.to_string())
    }

    /// Adds the name of the input (or output) that the error concerns, unless it has one already.
    #[must_use]
    pub fn of_input(mut self, input: impl Into<String>) -> Self {
        self.input.get_or_insert_with(|| input.into());
        self
    }

    /// Adds the position in the input ("block 812 at byte 40960", "line 7"), unless it has one already.
    #[must_use]
    pub fn at(mut self, position: impl Into<String>) -> Self {
        self.position.get_or_insert_with(|| position.into());
        self
    }

    /// Adds a note in parentheses to the message, such as a remedy.
    #[must_use]
    pub fn noting(mut self, note: &str) -> Self {
        self.message += &format!(" ({note})");
        self
    }

    /// Whether the machine has too little memory, disk or descriptors: no input is to blame.
    pub fn is_shortage(&self) -> bool {
        use io::ErrorKind::{OutOfMemory, QuotaExceeded, StorageFull};
        self.kind == ErrorKind::Memory
            || self.cause.as_ref().is_some_and(|cause| {
                // ENFILE and EMFILE, which have no kind.
                matches!(cause.kind(), OutOfMemory | QuotaExceeded | StorageFull)
                    || matches!(cause.raw_os_error(), Some(23 | 24))
            })
    }

    /// The name of the input or output that it concerns, if it has one.
    pub fn input(&self) -> Option<&str> {
        self.input.as_deref()
    }

    /// Kind of the failure.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// Process exit code of this failure.
    pub fn exit_code(&self) -> u8 {
        self.kind.exit_code()
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(input) = &self.input {
            write!(f, "{input}: ")?;
        }
        if let Some(position) = &self.position {
            write!(f, "{position}: ")?;
        }
        f.write_str(&self.message)?;
        match &self.cause {
            Some(cause) => write!(f, ": {cause}"),
            None => Ok(()),
        }
    }
}

/// `source` stays `None`: the message includes the cause, which would otherwise be printed twice.
impl std::error::Error for Error {}

/// A count with the word for what is counted, in the singular or the plural: "1 point", "0 points".
pub fn counted(number: u64, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

/// A part of a count: "1 of 1 point is", "1 of 3 points is", "2 of 3 points are". `of` are the words for what
/// is counted, in the singular and the plural, and `verbs` those for what is said of the part.
pub fn counted_of(number: u64, all: u64, of: [&str; 2], verbs: [&str; 2]) -> String {
    format!("{number} of {} {}", counted(all, of[0], of[1]), verbs[usize::from(number != 1)])
}
