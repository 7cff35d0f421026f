//! The one gzip layer: inputs that may be compressed with gzip, which their first bytes tell.

use std::io::{self, BufRead, BufReader, Chain, Cursor, ErrorKind, Read};

use flate2::bufread::GzDecoder;

use spmesh_core::system::expect_inflate_memory;

/// First bytes of gzip data.
const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Bytes read at once.
const BUFFER_LEN: usize = 1 << 17;

/// An input whose first bytes were read to recognize it.
type Whole<R> = Chain<Cursor<Vec<u8>>, R>;

/// The plain bytes of an input, compressed with gzip or not.
///
/// Damaged or truncated gzip data is an error of kind [`ErrorKind::InvalidData`] that names the byte.
pub struct Plain<R> {
    inner: Inner<R>,
}

enum Inner<R> {
    AsIs(Whole<R>),
    Gzip(Box<Gunzip<Whole<R>>>),
}

impl<R: Read> Plain<R> {
    /// Looks at the first two bytes of `input`.
    ///
    /// # Errors
    /// If reading fails.
    pub fn new(mut input: R) -> io::Result<Self> {
        let mut start = Vec::new();
        (&mut input).take(MAGIC.len() as u64).read_to_end(&mut start)?;
        let is_gzip = start == MAGIC;
        let whole = Cursor::new(start).chain(input);
        let inner = if is_gzip { Inner::Gzip(Box::new(Gunzip::new(whole))) } else { Inner::AsIs(whole) };
        Ok(Plain { inner })
    }

    /// Whether the input is compressed.
    pub fn is_compressed(&self) -> bool {
        matches!(self.inner, Inner::Gzip(_))
    }
}

impl<R: Read> Read for Plain<R> {
    #[inline]
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match &mut self.inner {
            Inner::AsIs(input) => input.read(buffer),
            Inner::Gzip(input) => input.read(buffer),
        }
    }
}

/// Decompresses gzip data of any number of members. Damaged data is an error that names the byte.
///
/// The checksum and the length of a member are verified when reading goes on after its last byte.
pub(super) struct Gunzip<R> {
    /// `None` only while the next member begins.
    member: Option<Member<R>>,
}

/// Decompresses one member.
type Member<R> = GzDecoder<BufReader<Counted<R>>>;

impl<R: Read> Gunzip<R> {
    pub(super) fn new(input: R) -> Self {
        expect_inflate_memory();
        let input = BufReader::with_capacity(BUFFER_LEN, Counted { input, bytes: 0, failed: false });
        Gunzip { member: Some(GzDecoder::new(input)) }
    }

    fn member(&mut self) -> &mut Member<R> {
        self.member.as_mut().expect("a member is there between reads")
    }

    fn read_on(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let read = self.member().read(buffer)?;
            if read > 0 || buffer.is_empty() || skip_zeros(self.member().get_mut())? {
                return Ok(read);
            }
            self.member = self.member.take().map(|ended| GzDecoder::new(ended.into_inner()));
        }
    }

    /// Names the byte of the compressed data where decompression failed, and makes the error
    /// [`ErrorKind::InvalidData`]. Errors of reading stay as they are.
    #[cold]
    fn locate(&mut self, error: io::Error) -> io::Error {
        let input = self.member().get_ref();
        if input.get_ref().failed {
            return error;
        }
        let byte = input.get_ref().bytes - input.buffer().len() as u64;
        let found = match error.kind() {
            ErrorKind::UnexpectedEof => "ends early: it was cut off, or other bytes follow it,".to_string(),
            _ => format!("is damaged ({error})"),
        };
        io::Error::new(ErrorKind::InvalidData, format!("the gzip data {found} at byte {byte} of the file"))
    }
}

impl<R: Read> Read for Gunzip<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.read_on(buffer).map_err(|e| match e.kind() {
            ErrorKind::Interrupted => e,
            _ => self.locate(e),
        })
    }
}

/// Skips zeros, with which tapes and block devices fill up their last block (gzip(1) ignores them too). True
/// if the input ends after them.
fn skip_zeros(input: &mut impl BufRead) -> io::Result<bool> {
    loop {
        let bytes = input.fill_buf()?;
        if bytes.is_empty() {
            return Ok(true);
        }
        let zeros = bytes.iter().take_while(|byte| **byte == 0).count();
        if zeros == 0 {
            return Ok(false);
        }
        input.consume(zeros);
    }
}

/// Counts the bytes that are read, and remembers whether reading itself failed.
struct Counted<R> {
    input: R,
    bytes: u64,
    failed: bool,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let result = self.input.read(buffer);
        match &result {
            Ok(len) => self.bytes += *len as u64,
            Err(e) => self.failed |= e.kind() != ErrorKind::Interrupted,
        }
        result
    }
}
