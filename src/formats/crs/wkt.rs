//! Well-known text as a tree: the syntax that WKT 1, WKT 2 and ESRI's dialect share.
//!
//! Source: OGC 18-010r11 (WKT 2), section 6; OGC 01-009 (WKT 1), section 7.

use std::borrow::Cow;

use spmesh_base::limits::CRS_DEPTH_MAX;

/// A keyword with the values in its brackets.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node<'t> {
    pub(crate) keyword: &'t str,
    pub(crate) values: Vec<Value<'t>>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value<'t> {
    /// A text in quotation marks.
    Text(Cow<'t, str>),
    /// A number, or a word such as `north`.
    Word(&'t str),
    Node(Node<'t>),
}

impl<'t> Node<'t> {
    /// Whether the keyword is one of `keywords`, in any case.
    pub(crate) fn is(&self, keywords: &[&str]) -> bool {
        keywords.iter().any(|keyword| self.keyword.eq_ignore_ascii_case(keyword))
    }

    /// The first text: the name of what the node defines.
    pub(crate) fn name(&self) -> &str {
        self.values.iter().find_map(Value::text).unwrap_or_default()
    }

    /// The value at `place`, as a number.
    pub(crate) fn number(&self, place: usize) -> Option<f64> {
        match self.values.get(place)? {
            Value::Word(word) => word.parse().ok().filter(|number: &f64| number.is_finite()),
            _ => None,
        }
    }

    /// The nodes among the values.
    pub(crate) fn children(&self) -> impl Iterator<Item = &Node<'t>> + Clone {
        self.values.iter().filter_map(|value| match value {
            Value::Node(node) => Some(node),
            _ => None,
        })
    }

    /// The first node among the values whose keyword is one of `keywords`.
    pub(crate) fn child(&self, keywords: &[&str]) -> Option<&Node<'t>> {
        self.children().find(|child| child.is(keywords))
    }

    /// The EPSG code that the node gives itself: AUTHORITY in WKT 1, ID in WKT 2.
    pub(crate) fn code(&self) -> Option<u32> {
        let of_epsg = |id: &&Node| id.is(&["AUTHORITY", "ID"]) && id.name().eq_ignore_ascii_case("EPSG");
        let id = self.children().find(of_epsg)?;
        match id.values.get(1)? {
            Value::Text(code) => code.trim().parse().ok(),
            Value::Word(code) => code.parse().ok(),
            Value::Node(_) => None,
        }
    }
}

impl Value<'_> {
    fn text(&self) -> Option<&str> {
        if let Value::Text(text) = self { Some(text) } else { None }
    }

    /// Whether it is `word`, in any case.
    pub(crate) fn is(&self, word: &str) -> bool {
        matches!(self, Value::Word(own) if own.eq_ignore_ascii_case(word))
    }

    /// Whether it is a text with `part` in it.
    pub(crate) fn contains(&self, part: &str) -> bool {
        self.text().is_some_and(|text| text.contains(part))
    }
}

/// The nodes of `text`: one, except that ESRI writes a vertical system behind a horizontal one.
pub(crate) fn parse(text: &str) -> Result<Vec<Node<'_>>, String> {
    let mut parser = Parser { text, at: 0 };
    let mut nodes = Vec::new();
    loop {
        nodes.push(parser.node(0)?);
        if !parser.takes(",") {
            break;
        }
    }
    // Some writers close more brackets than they open.
    while parser.takes("])") {}
    if parser.peek().is_some() { Err(parser.fault("the end of the text")) } else { Ok(nodes) }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    /// The next character behind white space.
    fn peek(&mut self) -> Option<char> {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
        self.rest().chars().next()
    }

    /// Goes past the next character if it is one of `symbols`.
    fn takes(&mut self, symbols: &str) -> bool {
        let next = self.peek().filter(|&next| symbols.contains(next));
        self.at += next.map_or(0, char::len_utf8);
        next.is_some()
    }

    fn fault(&self, expected: &str) -> String {
        match self.rest().chars().next() {
            Some(found) => format!("byte {}: expected {expected}, found {found:?}", self.at),
            None => format!("byte {}: expected {expected}, found the end", self.at),
        }
    }

    fn node(&mut self, depth: usize) -> Result<Node<'t>, String> {
        let keyword = self.word()?;
        self.opened(keyword, depth)
    }

    /// The node of `keyword`, whose bracket comes next.
    fn opened(&mut self, keyword: &'t str, depth: usize) -> Result<Node<'t>, String> {
        if depth == CRS_DEPTH_MAX {
            return Err(format!("byte {}: more than {CRS_DEPTH_MAX} levels of brackets", self.at));
        }
        if !self.takes("[(") {
            return Err(self.fault("an opening bracket"));
        }
        let mut values = Vec::new();
        loop {
            values.push(self.value(depth)?);
            if self.takes("])") {
                return Ok(Node { keyword, values });
            }
            if !self.takes(",") {
                return Err(self.fault("a comma or a closing bracket"));
            }
        }
    }

    fn value(&mut self, depth: usize) -> Result<Value<'t>, String> {
        if self.takes("\"") {
            return self.quoted().map(Value::Text);
        }
        let word = self.word()?;
        match self.peek() {
            Some('[' | '(') => self.opened(word, depth + 1).map(Value::Node),
            _ => Ok(Value::Word(word)),
        }
    }

    /// A keyword or a number.
    fn word(&mut self) -> Result<&'t str, String> {
        self.peek();
        let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '+' | '-' | '.' | ':');
        let len = self.rest().find(|c| !is_part(c)).unwrap_or(self.rest().len());
        if len == 0 {
            return Err(self.fault("a keyword, a number or a text"));
        }
        let word = &self.rest()[..len];
        self.at += len;
        Ok(word)
    }

    /// The text up to its closing quotation mark; two marks stand for one.
    fn quoted(&mut self) -> Result<Cow<'t, str>, String> {
        let mut text = Cow::Borrowed("");
        loop {
            let len = self
                .rest()
                .find('"')
                .ok_or_else(|| format!("byte {}: a text without its closing quotation mark", self.at))?;
            text += &self.rest()[..len];
            self.at += len + 1;
            if !self.rest().starts_with('"') {
                return Ok(text);
            }
            text += "\"";
            self.at += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_numbers_words_and_texts() {
        let nodes = parse("A[\"x \"\"y\"\"\", -1.5e3 ,B(north), ID[\"epsg\",4326]] , C[2]\n").unwrap();
        assert_eq!(nodes.len(), 2);
        let a = &nodes[0];
        assert_eq!(
            (a.name(), a.number(1), a.number(0), a.code()),
            ("x \"y\"", Some(-1500.), None, Some(4326))
        );
        assert_eq!(a.child(&["b"]).unwrap().values, [Value::Word("north")]);
        assert!(nodes[1].is(&["c"]) && nodes[1].number(0) == Some(2.));
    }

    #[test]
    fn faults_have_a_place() {
        let fault = |text: &str| parse(text).unwrap_err();
        assert_eq!(fault(""), "byte 0: expected a keyword, a number or a text, found the end");
        assert_eq!(fault("A"), "byte 1: expected an opening bracket, found the end");
        assert_eq!(fault("A[\"x"), "byte 3: a text without its closing quotation mark");
        assert_eq!(fault("A[1 2]"), "byte 4: expected a comma or a closing bracket, found '2'");
        assert_eq!(fault("A[1] B[2]"), "byte 5: expected the end of the text, found 'B'");
        assert_eq!(parse("A[1]]"), parse("A[1]"));
        assert!(fault(&"A[".repeat(100_000)).ends_with("more than 32 levels of brackets"));
        let nested = |depth: usize| "A[".repeat(depth) + "1" + &"]".repeat(depth);
        assert!(parse(&nested(CRS_DEPTH_MAX)).is_ok());
        assert!(fault(&nested(CRS_DEPTH_MAX + 1)).ends_with("more than 32 levels of brackets"));
    }
}
