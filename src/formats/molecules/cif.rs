//! Tokens of CIF 1.1, the syntax of mmCIF.

use std::io::Read;

use crate::text::lines::Lines;

use spmesh_base::error::{Error, Result};

/// Type of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Token {
    /// `data_` with the name of a block.
    Data,
    /// `loop_`.
    Loop,
    /// `save_`, with the name of a frame or without one at its end.
    Save,
    /// The name of an item, with its underscore.
    Tag,
    /// A value without quotes.
    Value,
    /// A value in quotes, or a text field of several lines.
    Quoted,
    /// The end of the input.
    End,
}

/// Reads tokens; the first is current from the start. Memory: a line, and a text field.
pub(crate) struct Tokens<R> {
    lines: Lines<R>,
    token: Token,
    /// Range of the token's text in the line; text fields are in `field`.
    start: usize,
    end: usize,
    /// Column at which the search for the next token starts.
    next: usize,
    field: Vec<u8>,
    is_field: bool,
}

impl<R: Read> Tokens<R> {
    /// Reads the first token.
    pub(crate) fn new(lines: Lines<R>) -> Result<Self> {
        let mut tokens = Tokens {
            lines,
            token: Token::End,
            start: 0,
            end: 0,
            next: 0,
            field: Vec::new(),
            is_field: false,
        };
        tokens.next_line()?;
        tokens.advance()?;
        Ok(tokens)
    }

    /// Type of the current token.
    pub(crate) fn token(&self) -> Token {
        self.token
    }

    /// Text of the current token: values without their quotes, whole tags, and the names of blocks.
    pub(crate) fn text(&self) -> &[u8] {
        if self.is_field { &self.field } else { &self.lines.current()[self.start..self.end] }
    }

    /// Line in which the current token ends, counted from 1.
    pub(crate) fn line(&self) -> u64 {
        self.lines.number()
    }

    /// Number of the input's last line, if that has no line end.
    pub(crate) fn unended(&self) -> Option<u64> {
        self.lines.unended()
    }

    /// Reads the next token.
    pub(crate) fn advance(&mut self) -> Result<Token> {
        self.token = self.read().map_err(|e| self.locate(e))?;
        Ok(self.token)
    }

    /// Adds input, line and column to an error about the current token.
    pub(crate) fn locate(&self, error: Error) -> Error {
        let column = if self.is_field { 1 } else { self.start + 1 };
        self.lines.locate(error.at(format!("line {}, column {column}", self.line())))
    }

    fn read(&mut self) -> Result<Token> {
        self.is_field = false;
        loop {
            let line = self.lines.current();
            if self.next == 0 && line.first() == Some(&b';') {
                return self.read_field();
            }
            let rest = &line[self.next..];
            match rest.iter().position(|&byte| !is_blank(byte)) {
                Some(blanks) if rest[blanks] != b'#' => {
                    self.start = self.next + blanks;
                    return self.read_in_line();
                }
                _ if self.next_line()? => {}
                _ => return Ok(Token::End),
            }
        }
    }

    /// Goes to the next line; false at the end of the input, where the line is empty.
    fn next_line(&mut self) -> Result<bool> {
        (self.start, self.end, self.next) = (0, 0, 0);
        let Some(line) = self.lines.next_line()? else { return Ok(false) };
        if line.contains(&b'\r') {
            return Err(Error::malformed(
                "carriage return inside of a line: lines must end with LF or CR LF",
            ));
        }
        Ok(true)
    }

    /// Reads the token that starts in the line.
    fn read_in_line(&mut self) -> Result<Token> {
        let line = self.lines.current();
        let first = line[self.start];
        if matches!(first, b'\'' | b'"') {
            self.start += 1;
            let rest = &line[self.start..];
            let is_end =
                |&at: &usize| rest[at] == first && rest.get(at + 1).is_none_or(|&byte| is_blank(byte));
            let Some(len) = (0..rest.len()).find(is_end) else {
                return Err(Error::malformed("the quotation has no end in its line"));
            };
            (self.end, self.next) = (self.start + len, self.start + len + 1);
            return Ok(Token::Quoted);
        }
        let rest = &line[self.start..];
        self.end = self.start + rest.iter().position(|&byte| is_blank(byte)).unwrap_or(rest.len());
        self.next = self.end;
        let word = &line[self.start..self.end];
        let token = match first {
            b'_' => Token::Tag,
            b'd' | b'D' if starts_with(word, b"data_") => Token::Data,
            b's' | b'S' if starts_with(word, b"save_") => Token::Save,
            b'l' | b'L' if word.eq_ignore_ascii_case(b"loop_") => Token::Loop,
            b'g' | b'G' if word.eq_ignore_ascii_case(b"global_") => return Err(reserved("global_")),
            b's' | b'S' if word.eq_ignore_ascii_case(b"stop_") => return Err(reserved("stop_")),
            _ => Token::Value,
        };
        if matches!(token, Token::Data | Token::Save) {
            self.start += b"data_".len();
        }
        Ok(token)
    }

    /// Reads a text field: from the semicolon at the start of a line to the next semicolon at the start of a
    /// line.
    fn read_field(&mut self) -> Result<Token> {
        let first = self.line();
        self.field.clear();
        self.field.extend_from_slice(&self.lines.current()[1..]);
        loop {
            if !self.next_line()? {
                let reason = format!("truncated: the text field that starts in line {first} has no end");
                return Err(Error::malformed(reason));
            }
            let line = self.lines.current();
            if line.first() == Some(&b';') {
                break;
            }
            self.field.push(b'\n');
            self.field.extend_from_slice(line);
        }
        (self.start, self.end, self.next) = (0, 1, 1);
        self.is_field = true;
        Ok(Token::Quoted)
    }
}

fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte == b'\t'
}

fn starts_with(word: &[u8], start: &[u8]) -> bool {
    word.get(..start.len()).is_some_and(|found| found.eq_ignore_ascii_case(start))
}

fn reserved(word: &str) -> Error {
    Error::malformed(format!("found {word}, which CIF reserves and mmCIF does not use"))
}
