//! What `fixpair.h` promises a compiled program, read from its text: constants, types, structs with their members, and functions.
//!
//! The text is cbindgen's, one regular style; this is no parser of C.

/// A declaration, and the macro that hides it, if any.
pub(crate) struct Declaration {
    pub(crate) item: Item,
    pub(crate) hidden_by: Option<String>,
}

pub(crate) enum Item {
    Constant { name: String, real: bool },
    Alias { name: String, of: String },
    Opaque { name: String },
    Struct { name: String, members: Vec<Named> },
    Function(Named),
}

/// A member or a function: its name, and its type without any name.
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) kind: String,
}

pub(crate) fn read(header: &str) -> Vec<Declaration> {
    let mut found = Vec::new();
    let mut conditions: Vec<&str> = Vec::new();
    let mut statement = String::new();
    let code = without_comments(header);
    for line in code.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let hidden = conditions.iter().find_map(|condition| condition.strip_prefix("!defined("));
        let hidden_by = hidden.map(|macro_| macro_.trim_end_matches(')').to_owned());
        if let Some(define) = line.strip_prefix("#define ") {
            if let Some((name, value)) = define.split_once(' ') {
                let item = Item::Constant { name: name.to_owned(), real: value.contains('.') };
                found.push(Declaration { item, hidden_by });
            }
        } else if line == "#endif" {
            conditions.pop().expect("as many #if as #endif");
        } else if line.starts_with("#if") {
            conditions.push(line.split_once(' ').expect("a condition").1);
        } else if !line.starts_with("#include") && !conditions.contains(&"__cplusplus") {
            statement.push_str(line);
            statement.push(' ');
            let open = statement.matches('{').count() > statement.matches('}').count();
            if !open && let Some(whole) = statement.trim_end().strip_suffix(';') {
                found.push(Declaration { item: item(whole), hidden_by });
                statement.clear();
            }
        }
    }
    assert!(statement.is_empty(), "the header ends within: {statement}");
    found
}

fn without_comments(text: &str) -> String {
    let mut code = String::new();
    for (i, part) in text.split("/*").enumerate() {
        code.push_str(if i == 0 { part } else { part.split_once("*/").expect("comments end").1 });
    }
    code.lines()
        .map(|line| line.split("//").next().unwrap_or_default().trim_end())
        .collect::<Vec<_>>()
        .join("\n")
}

fn item(statement: &str) -> Item {
    let Some(definition) = statement.strip_prefix("typedef ") else {
        return Item::Function(function(statement));
    };
    let Some(definition) = definition.strip_prefix("struct ") else {
        let Named { name, kind } = variable(definition);
        return Item::Alias { name, of: kind };
    };
    let name = definition.split(' ').next().expect("a name").to_owned();
    let Some((_, body)) = definition.split_once('{') else {
        return Item::Opaque { name };
    };
    let (body, _) = body.rsplit_once('}').expect("a struct ends");
    let members = body.split(';').map(str::trim).filter(|member| !member.is_empty());
    Item::Struct { name, members: members.map(variable).collect() }
}

fn function(statement: &str) -> Named {
    let (before, parameters) = statement.split_once('(').expect("a function has parameters");
    let Named { name, kind } = variable(before);
    Named { name, kind: format!("{kind}({})", types(parameters)) }
}

/// Splits `double root[6][6]`, or a pointer to a function, into name and type.
fn variable(declaration: &str) -> Named {
    if let Some((result, rest)) = declaration.split_once("(*") {
        let (name, parameters) = rest.split_once(")(").expect("a pointer to a function");
        return Named { name: name.to_owned(), kind: format!("{result}(*)({})", types(parameters)) };
    }
    let (declaration, array) = declaration.split_at(declaration.find('[').unwrap_or(declaration.len()));
    let start = declaration.rfind([' ', '*']).expect("a type and a name") + 1;
    let (kind, name) = declaration.split_at(start);
    Named { name: name.to_owned(), kind: format!("{}{array}", kind.trim_end()) }
}

/// The types of parameters, which end with the parenthesis that closes them.
fn types(parameters: &str) -> String {
    let parameters = parameters.trim().strip_suffix(')').expect("parameters end");
    if parameters == "void" {
        return parameters.to_owned();
    }
    let mut depth = 0;
    let mut list = vec![String::new()];
    for letter in parameters.chars() {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        if letter == ',' && depth == 0 {
            list.push(String::new());
        } else {
            list.last_mut().expect("one at least").push(letter);
        }
    }
    list.iter().map(|parameter| variable(parameter.trim()).kind).collect::<Vec<_>>().join(", ")
}
