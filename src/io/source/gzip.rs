//! The one gzip layer: inputs that may be compressed with gzip, which their first bytes tell.

use std::io::{self, BufReader, Chain, Cursor, ErrorKind, Read};

use flate2::bufread::MultiGzDecoder;

use spmesh_core::system::expect_deflate_memory;

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
pub(super) struct Gunzip<R> {
    decoder: MultiGzDecoder<BufReader<Counted<R>>>,
}

impl<R: Read> Gunzip<R> {
    pub(super) fn new(input: R) -> Self {
        expect_deflate_memory();
        let input = Counted { input, bytes: 0, failed: false };
        Gunzip { decoder: MultiGzDecoder::new(BufReader::with_capacity(BUFFER_LEN, input)) }
    }

    /// Names the byte of the compressed data where decompression failed, and makes the error
    /// [`ErrorKind::InvalidData`]. Errors of reading stay as they are.
    #[cold]
    fn locate(&self, error: io::Error) -> io::Error {
        let input = self.decoder.get_ref();
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
        self.decoder.read(buffer).map_err(|e| match e.kind() {
            ErrorKind::Interrupted => e,
            _ => self.locate(e),
        })
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
