//! Reads the tokens, imports and paths of one source file, without comments, strings and tests.

use std::collections::BTreeMap;

/// One source file, as far as its imports go.
#[derive(Debug, Default)]
pub(super) struct Source {
    /// Target path of each name that a `use` brings into the module.
    pub(super) imports: BTreeMap<String, Vec<String>>,
    /// Every path that the code uses: imports, and paths of two or more segments.
    pub(super) paths: Vec<Vec<String>>,
    /// The file defines something itself, beyond declaring modules and re-exporting names.
    pub(super) has_code: bool,
}

impl Source {
    /// Parses the text of a file.
    pub(super) fn parse(text: &str) -> Self {
        let tokens = tokens(text);
        let (mut found, mut exports, mut rest) = (Self::default(), Vec::new(), Vec::new());
        let mut at = 0;
        while at < tokens.len() {
            if tokens[at..].starts_with(&["#", "[", "cfg", "(", "test", ")", "]"].map(String::from)) {
                at = end_of_item(&tokens, at + 7);
            } else if tokens[at..].starts_with(&["pub", "(", "in"].map(String::from)) {
                at += tokens[at..].iter().position(|token| token == ")").unwrap_or(tokens.len());
            } else if tokens[at] == "use" {
                let is_export = at > 0 && matches!(&*tokens[at - 1], "pub" | ")");
                let end = end_of_statement(&tokens, at);
                for (name, path) in use_leaves(&tokens[at + 1..end]) {
                    if is_export {
                        exports.push((name.clone(), path.clone()));
                    } else {
                        found.paths.push(path.clone());
                    }
                    found.imports.insert(name, path);
                }
                at = end + 1;
            } else {
                rest.push(tokens[at].clone());
                at += 1;
            }
        }
        found.read_code(&rest);
        // A re-export is an import only where the file uses the name itself.
        found.paths.extend(exports.into_iter().filter(|(name, _)| rest.contains(name)).map(|(_, path)| path));
        found
    }

    fn read_code(&mut self, tokens: &[String]) {
        let items =
            ["fn", "struct", "enum", "union", "trait", "impl", "const", "static", "type", "macro_rules"];
        self.has_code = tokens.iter().any(|token| items.contains(&&**token));
        let mut at = 0;
        while at < tokens.len() {
            let mut path = vec![tokens[at].clone()];
            while is_name(&tokens[at]) && tokens[at + 1..].starts_with(&["::".to_owned()]) {
                let Some(next) = tokens.get(at + 2).filter(|next| is_name(next)) else { break };
                path.push(next.clone());
                at += 2;
            }
            if path.len() > 1 {
                self.paths.push(path);
            }
            at += 1;
        }
    }
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Index of the `;` that ends the statement at `at`.
fn end_of_statement(tokens: &[String], at: usize) -> usize {
    tokens[at..].iter().position(|token| token == ";").map_or(tokens.len(), |length| at + length)
}

/// Index after the item at `at`: behind its `;`, or behind its block where that begins first.
fn end_of_item(tokens: &[String], at: usize) -> usize {
    let mut depth = 0;
    for (index, token) in tokens.iter().enumerate().skip(at) {
        match &**token {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 && matches!(&**token, ";" | "}") {
            return index + 1;
        }
    }
    tokens.len()
}

/// Names and full paths that a `use` tree brings in.
fn use_leaves(tokens: &[String]) -> Vec<(String, Vec<String>)> {
    let (mut leaves, mut groups, mut path) = (Vec::new(), Vec::new(), Vec::<String>::new());
    let (mut alias, mut is_leaf) = (None, false);
    let mut tokens = tokens.iter().map(String::as_str).chain([","]);
    while let Some(token) = tokens.next() {
        match token {
            "::" => {}
            "{" => {
                groups.push(path.clone());
                is_leaf = false;
            }
            "," | "}" => {
                if let (true, Some(last)) = (std::mem::take(&mut is_leaf), path.last()) {
                    leaves.push((alias.take().unwrap_or_else(|| last.clone()), path));
                }
                if token == "}" {
                    groups.pop();
                }
                path = groups.last().cloned().unwrap_or_default();
            }
            "as" => alias = tokens.next().map(str::to_owned),
            "self" if !path.is_empty() => is_leaf = true,
            name => {
                path.push(name.to_owned());
                is_leaf = true;
            }
        }
    }
    leaves
}

/// Names, `::` and single signs of a source text.
pub(super) fn tokens(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let (mut found, mut at) = (Vec::new(), 0);
    while let Some(&c) = chars.get(at) {
        let start = at;
        if let Some(end) = end_of_comment_or_literal(&chars, at) {
            at = end;
            continue;
        }
        at += 1;
        if c.is_alphanumeric() || c == '_' {
            while chars.get(at).is_some_and(|c| c.is_alphanumeric() || *c == '_') {
                at += 1;
            }
        } else if c == ':' && chars.get(at) == Some(&':') {
            at += 1;
        } else if c.is_whitespace() {
            continue;
        }
        found.push(chars[start..at].iter().collect());
    }
    found
}

/// Index behind the comment, string or character literal that begins at `at`, if one does.
fn end_of_comment_or_literal(chars: &[char], at: usize) -> Option<usize> {
    let rest = &chars[at..];
    let is_within_name = at > 0 && (chars[at - 1].is_alphanumeric() || chars[at - 1] == '_');
    match rest {
        ['/', '/', ..] => Some(find(chars, at, &['\n'])),
        ['/', '*', ..] => Some(end_of_block_comment(chars, at)),
        ['b' | 'c', tail @ ..]
            if !is_within_name && matches!(tail, ['"' | '\'', ..] | ['r', '"' | '#', ..]) =>
        {
            end_of_comment_or_literal(&[&[' '], &chars[at + 1..]].concat(), 1).map(|end| at + end)
        }
        ['r', '"' | '#', ..] if !is_within_name => {
            let hashes = rest[1..].iter().take_while(|c| **c == '#').count();
            let is_raw = rest.get(1 + hashes) == Some(&'"');
            let mut close = vec!['"'];
            close.extend(vec!['#'; hashes]);
            is_raw.then(|| find(chars, at + 2 + hashes, &close))
        }
        ['"', ..] => Some(end_of_quoted(chars, at + 1, '"')),
        ['\'', '\\', ..] | ['\'', _, '\'', ..] => Some(end_of_quoted(chars, at + 1, '\'')),
        _ => None,
    }
}

/// Index behind the first `pattern` from `at` on.
fn find(chars: &[char], at: usize, pattern: &[char]) -> usize {
    let found = chars[at..].windows(pattern.len()).position(|window| window == pattern);
    found.map_or(chars.len(), |index| at + index + pattern.len())
}

fn end_of_quoted(chars: &[char], mut at: usize, quote: char) -> usize {
    while let Some(&c) = chars.get(at) {
        at += if c == '\\' { 2 } else { 1 };
        if c == quote {
            return at;
        }
    }
    chars.len()
}

/// Block comments nest.
fn end_of_block_comment(chars: &[char], mut at: usize) -> usize {
    let mut depth = 0;
    while at < chars.len() {
        match chars[at..] {
            ['/', '*', ..] => (depth, at) = (depth + 1, at + 2),
            ['*', '/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    chars.len()
}
