//! Paths that the items of a module name.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::parse::Parser;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{
    Attribute, Block, Expr, ExprAssign, GenericParam, Generics, ImplItemFn, Item, ItemMacro,
    ItemUse, LitStr, Macro, Meta, PatIdent, Path, Signature, Token, TraitItemFn, Visibility,
};

use super::uses::{Names, attributes, defined, test_only, text, uses};

/// A path that is named.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Named {
    pub(super) path: Names,
    /// Mark of a name that is only handed on.
    pub(super) public: bool,
}

/// Finds every path that the items name, but those that begin with a local name.
pub(super) fn named(items: &[Item]) -> BTreeSet<Named> {
    let mut finder = Finder::default();
    for item in items {
        finder.visit_item(item);
    }
    finder.found
}

/// Meaning of a name within a function, or within an item with parameters.
#[derive(Clone)]
enum Local {
    /// A variable, which no longer path begins with.
    Value,
    /// A parameter or an inner item.
    Item,
    /// A path that a `use` in the function brings in.
    Used(Names),
}

/// Local names of one function or item.
#[derive(Default)]
struct Locals(BTreeMap<String, Local>);

impl Locals {
    fn of(signature: Option<&Signature>, block: Option<&Block>) -> Self {
        let mut locals = Self::default();
        if let Some(signature) = signature {
            locals.visit_signature(signature);
        }
        if let Some(block) = block {
            locals.visit_block(block);
        }
        locals
    }
}

impl<'a> Visit<'a> for Locals {
    fn visit_pat_ident(&mut self, pattern: &'a PatIdent) {
        if !is_constant(pattern) {
            self.0.entry(text(&pattern.ident)).or_insert(Local::Value);
        }
        visit::visit_pat_ident(self, pattern);
    }

    fn visit_generic_param(&mut self, parameter: &'a GenericParam) {
        let ident = match parameter {
            GenericParam::Type(parameter) => &parameter.ident,
            GenericParam::Const(parameter) => &parameter.ident,
            _ => return,
        };
        self.0.insert(text(ident), Local::Item);
    }

    fn visit_item(&mut self, item: &'a Item) {
        if let Item::Use(item) = item {
            for used in uses(item) {
                if let Some(name) = used.name {
                    self.0.insert(name, Local::Used(used.path));
                }
            }
        }
        if let Some(name) = defined(item) {
            self.0.insert(name, Local::Item);
        }
    }

    fn visit_macro(&mut self, called: &'a Macro) {
        for argument in &arguments(called).unwrap_or_default() {
            self.visit_expr(argument);
        }
    }
}

#[derive(Default)]
struct Finder {
    scopes: Vec<Locals>,
    found: BTreeSet<Named>,
}

impl Finder {
    fn within(&mut self, locals: Locals, visit: impl FnOnce(&mut Self)) {
        self.scopes.push(locals);
        visit(self);
        self.scopes.pop();
    }

    fn add(&mut self, mut path: Names) {
        let Some(head) = path.first() else {
            return;
        };
        let local = self.scopes.iter().rev().find_map(|scope| {
            let local = scope.0.get(head)?;
            (path.len() == 1 || !matches!(local, Local::Value)).then_some(local)
        });
        match local {
            None => {}
            Some(Local::Value | Local::Item) => return,
            Some(Local::Used(used)) => {
                path.splice(..1, used.iter().cloned());
            }
        }
        let public = false;
        self.found.insert(Named { path, public });
    }

    fn add_path(&mut self, path: &Path) {
        if path.leading_colon.is_none() {
            self.add(path.segments.iter().map(|part| text(&part.ident)).collect());
        }
    }

    /// Reads paths off tokens that are no expression; those of one name too if `single`.
    fn scan(&mut self, tokens: TokenStream, single: bool) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < tokens.len() {
            match &tokens[at] {
                TokenTree::Group(group) => self.scan(group.stream(), single),
                TokenTree::Literal(literal) if !single => {
                    let text = syn::parse_str::<LitStr>(&literal.to_string());
                    if let Ok(path) = text.and_then(|text| text.parse::<Path>())
                        && path.segments.len() > 1
                    {
                        self.add_path(&path);
                    }
                }
                TokenTree::Ident(_) => {
                    let path = path_at(&tokens, at);
                    let after = at + 3 * path.len() - 2;
                    let whole = path.len() > 1 || single && !is_key(&tokens[after..]);
                    if whole && begins_path(&tokens[..at], &path[0]) {
                        self.add(path);
                    }
                    at = after - 1;
                }
                _ => {}
            }
            at += 1;
        }
    }
}

impl<'a> Visit<'a> for Finder {
    fn visit_item(&mut self, item: &'a Item) {
        if test_only(attributes(item)) {
            return;
        }
        let locals = match item {
            Item::Fn(item) => Locals::of(Some(&item.sig), Some(&item.block)),
            Item::Const(item) => value(&item.expr),
            Item::Static(item) => value(&item.expr),
            _ => Locals::default(),
        };
        self.within(locals, |finder| visit::visit_item(finder, item));
    }

    fn visit_impl_item_fn(&mut self, item: &'a ImplItemFn) {
        if !test_only(&item.attrs) {
            let locals = Locals::of(Some(&item.sig), Some(&item.block));
            self.within(locals, |finder| visit::visit_impl_item_fn(finder, item));
        }
    }

    fn visit_trait_item_fn(&mut self, item: &'a TraitItemFn) {
        let locals = Locals::of(Some(&item.sig), item.default.as_ref());
        self.within(locals, |finder| visit::visit_trait_item_fn(finder, item));
    }

    fn visit_generics(&mut self, generics: &'a Generics) {
        if let Some(scope) = self.scopes.last_mut() {
            scope.visit_generics(generics);
        }
        visit::visit_generics(self, generics);
    }

    fn visit_item_use(&mut self, item: &'a ItemUse) {
        self.found.extend(uses(item).into_iter().map(|used| Named {
            path: used.path,
            public: used.public,
        }));
    }

    fn visit_path(&mut self, path: &'a Path) {
        self.add_path(path);
        visit::visit_path(self, path);
    }

    fn visit_pat_ident(&mut self, pattern: &'a PatIdent) {
        if is_constant(pattern) {
            self.add(vec![text(&pattern.ident)]);
        }
        visit::visit_pat_ident(self, pattern);
    }

    /// One name before `=` is a variable, or an argument's name in a macro.
    fn visit_expr_assign(&mut self, assign: &'a ExprAssign) {
        match &*assign.left {
            Expr::Path(left) if left.path.segments.len() == 1 => {}
            left => self.visit_expr(left),
        }
        self.visit_expr(&assign.right);
    }

    fn visit_item_macro(&mut self, item: &'a ItemMacro) {
        match item.ident {
            Some(_) => self.scan(item.mac.tokens.clone(), true),
            None => self.visit_macro(&item.mac),
        }
    }

    fn visit_macro(&mut self, called: &'a Macro) {
        self.add_path(&called.path);
        match arguments(called) {
            Some(arguments) => {
                for argument in &arguments {
                    self.visit_expr(argument);
                }
            }
            None => self.scan(called.tokens.clone(), true),
        }
    }

    fn visit_attribute(&mut self, attribute: &'a Attribute) {
        if let Meta::List(list) = &attribute.meta {
            self.scan(list.tokens.clone(), false);
        }
    }

    fn visit_visibility(&mut self, _: &'a Visibility) {}
}

fn value(expression: &Expr) -> Locals {
    let mut locals = Locals::default();
    locals.visit_expr(expression);
    locals
}

/// The arguments of a macro, if they are expressions.
fn arguments(called: &Macro) -> Option<Punctuated<Expr, Token![,]>> {
    let parser = Punctuated::<Expr, Token![,]>::parse_terminated;
    parser.parse2(called.tokens.clone()).ok()
}

/// Test for a pattern that is a constant's or a variant's name, going by its first letter.
fn is_constant(pattern: &PatIdent) -> bool {
    text(&pattern.ident).starts_with(char::is_uppercase)
}

/// The names from one token on that `::` joins.
fn path_at(tokens: &[TokenTree], mut at: usize) -> Names {
    let mut path = Vec::new();
    while let Some(TokenTree::Ident(ident)) = tokens.get(at) {
        path.push(text(ident));
        if !(is(tokens.get(at + 1), ':') && is(tokens.get(at + 2), ':')) {
            break;
        }
        at += 3;
    }
    path
}

/// Test for a name that stands for itself after these tokens: no field, lifetime or variable of a macro.
fn begins_path(before: &[TokenTree], head: &str) -> bool {
    let last = before.last();
    let first = before.len().checked_sub(2).and_then(|at| before.get(at));
    let field = is(last, '.') && !is(first, '.');
    let variable = is(last, '$') && head != "crate";
    let outer = is(last, ':') && is(first, ':');
    !(field || variable || outer || is(last, '\''))
}

/// Test for tokens that show that a name before them is a field's or an argument's.
fn is_key(after: &[TokenTree]) -> bool {
    let (first, second) = (after.first(), after.get(1));
    is(first, ':') || is(first, '=') && !is(second, '=') && !is(second, '>')
}

fn is(token: Option<&TokenTree>, sign: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == sign)
}
