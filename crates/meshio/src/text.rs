//! Lines, words and numbers of text files, with their line numbers.

use crate::error::Fault;

/// The lines of a text, ended by LF, CR LF or CR; a byte order mark is skipped.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

#[derive(Clone, Copy)]
pub(crate) struct Line<'a> {
    /// From 1.
    pub number: usize,
    /// Without its end.
    pub text: &'a [u8],
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0 }
    }

    /// What has not been read yet.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The number of the line read last: where a file ends too early.
    pub(crate) fn number(&self) -> usize {
        self.number.max(1)
    }

    /// The next line that holds a word.
    pub(crate) fn next_full(&mut self) -> Option<Line<'a>> {
        self.find(|line| line.words().next().is_some())
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let (text, rest) = self.rest.split_at(end);
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => rest,
        };
        Some(Line { number: self.number, text })
    }
}

impl<'a> Line<'a> {
    /// The words of the line, up to a comment.
    pub(crate) fn words(&self) -> Words<'a> {
        Words { rest: self.text, line: self.number }
    }
}

/// The words of a line, up to a comment.
#[derive(Clone, Default)]
pub(crate) struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = &self.rest[start..];
        if rest[0] == b'#' {
            self.rest = &[];
            return None;
        }
        let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
        self.rest = &rest[end..];
        Some(&rest[..end])
    }
}

impl Words<'_> {
    /// The words after the first.
    pub(crate) fn skip_keyword(mut self) -> Self {
        self.next();
        self
    }

    /// The next word as a finite number.
    pub(crate) fn number(&mut self, what: &str) -> Result<f64, Fault> {
        let line = self.line;
        let word = self.next().ok_or_else(|| Fault::at(line, format!("{what} is missing")))?;
        let value: f64 = parse(word).ok_or_else(|| {
            Fault::at(line, format!("{what} is {}, not a number{}", show(word), hint(word)))
        })?;
        if !value.is_finite() {
            return Err(Fault::at(line, format!("{what} is {}; remove or repair it", show(word))));
        }
        Ok(value)
    }

    /// The next three words as a finite position.
    pub(crate) fn position(&mut self) -> Result<[f64; 3], Fault> {
        Ok([self.number("coordinate x")?, self.number("coordinate y")?, self.number("coordinate z")?])
    }

    /// The next word as a number of something.
    pub(crate) fn whole(&mut self, what: &str) -> Result<u64, Fault> {
        let line = self.line;
        let word = self.next().ok_or_else(|| Fault::at(line, format!("{what} is missing")))?;
        parse(word)
            .ok_or_else(|| Fault::at(line, format!("{what} is {}, not a whole number >= 0", show(word))))
    }
}

/// The words of a text one after another, wherever its lines end.
#[derive(Clone)]
pub(crate) struct Tokens<'a> {
    rest: &'a [u8],
    line: usize,
    comments: bool,
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        self.skip_blank(false);
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

impl<'a> Tokens<'a> {
    /// The words of a text, without comments from `#` to the line's end.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), line: 1, comments: true }
    }

    /// The words of a text in which `#` has no meaning.
    pub(crate) fn without_comments(bytes: &'a [u8]) -> Self {
        Self { comments: false, ..Self::new(bytes) }
    }

    /// What has not been read yet.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The number of the line read last.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    #[inline]
    fn skip_blank(&mut self, within_line: bool) {
        while let [first, rest @ ..] = self.rest {
            match first {
                b'#' if self.comments => {
                    let end = rest.iter().position(|b| b"\n\r".contains(b)).unwrap_or(rest.len());
                    self.rest = &rest[end..];
                    continue;
                }
                b'\n' | b'\r' if within_line => return,
                b'\n' => self.line += 1,
                b'\r' if rest.first() != Some(&b'\n') => self.line += 1,
                b if b.is_ascii_whitespace() => {}
                _ => return,
            }
            self.rest = rest;
        }
    }

    /// Whether no word follows on this line.
    pub(crate) fn at_line_end(&mut self) -> bool {
        self.skip_blank(true);
        self.rest.first().is_none_or(|b| b"\n\r".contains(b))
    }

    /// Moves behind the end of this line, and gives what it still held.
    pub(crate) fn take_line(&mut self) -> &'a [u8] {
        let end = self.rest.iter().position(|b| b"\n\r".contains(b)).unwrap_or(self.rest.len());
        let (text, rest) = self.rest.split_at(end);
        self.line += usize::from(!rest.is_empty());
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => rest,
        };
        text
    }

    /// Takes bytes that are no text; `None` when there are fewer.
    pub(crate) fn take_bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (bytes, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(bytes)
    }

    pub(crate) fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault::at(self.line, reason)
    }

    /// The next word, or a fault that says what the file ends before.
    pub(crate) fn word(&mut self, what: &str) -> Result<&'a [u8], Fault> {
        self.next().ok_or_else(|| {
            self.fault(format!("the file ends before {what}; it is truncated; copy or export it again"))
        })
    }

    /// The next word as a number; NaN and infinity are numbers too.
    #[inline]
    pub(crate) fn number(&mut self, what: &str) -> Result<f64, Fault> {
        let word = self.word(what)?;
        parse(word).ok_or_else(|| self.fault(format!("{what} is {}, not a number{}", show(word), hint(word))))
    }

    /// The next word as a whole number.
    #[inline]
    pub(crate) fn whole<T: std::str::FromStr>(&mut self, what: &str) -> Result<T, Fault> {
        let word = self.word(what)?;
        parse(word).ok_or_else(|| self.fault(format!("{what} is {}, not a whole number", show(word))))
    }
}

/// A word as a number; numbers have a decimal point, whatever the locale.
#[inline]
pub(crate) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

fn hint(word: &[u8]) -> &'static str {
    if word.contains(&b',') { "; write decimals with a point" } else { "" }
}

/// A word for a message: quoted, printable, short.
pub(crate) fn show(word: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(&word[..word.len().min(24)]).escape_debug().collect();
    format!("\"{text}{}\"", if word.len() > 24 { "..." } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_three_ways() {
        let lines: Vec<_> = Lines::new(b"a\nb\r\nc\rd").map(|l| (l.number, l.text)).collect();
        assert_eq!(lines, [(1, &b"a"[..]), (2, b"b"), (3, b"c"), (4, b"d")]);
    }

    #[test]
    fn tokens_run_over_line_ends() {
        let mut tokens = Tokens::new(b"\xef\xbb\xbfa # b\r\nc d\re\n\n f g\nh");
        assert_eq!(tokens.next(), Some(&b"a"[..]));
        assert!(tokens.at_line_end());
        let found: Vec<_> =
            std::iter::from_fn(|| tokens.next().map(|w| (w, tokens.line()))).take(4).collect();
        assert_eq!(found, [(&b"c"[..], 2), (b"d", 2), (b"e", 3), (b"f", 5)]);
        assert!(!tokens.at_line_end());
        assert_eq!((tokens.take_line(), tokens.line()), (&b"g"[..], 6));
        assert_eq!((tokens.next(), tokens.next()), (Some(&b"h"[..]), None));
        assert_eq!(Tokens::without_comments(b"#a").next(), Some(&b"#a"[..]));
    }

    #[test]
    fn words_stop_at_a_comment() {
        let line = Line { number: 1, text: b" 1\t2 # 3" };
        assert_eq!(line.words().collect::<Vec<_>>(), [&b"1"[..], b"2"]);
    }

    #[test]
    fn numbers_say_what_is_wrong_with_them() {
        let read = |text| Line { number: 7, text }.words().number("x").map_err(|f| format!("{f:?}"));
        assert_eq!(read(b"1e-3").unwrap(), 1e-3);
        assert!(read(b"1,5").unwrap_err().contains("decimals with a point"));
        assert!(read(b"nan").unwrap_err().contains("repair"));
        assert!(read(b"1e999").unwrap_err().contains("repair"));
        assert!(read(b"").unwrap_err().contains("missing"));
    }
}
