"""Programs at random, of which most run: scalars, vectors, matrices, structures, cells, loops."""

SCALARS, VECTORS, MATRICES = ("a", "b", "n"), ("v", "w"), ("M", "N")
OF_ONE = ("sin", "cos", "abs", "sqrt", "exp", "floor", "sign", "round", "atan", "asin", "log")
OF_TWO = ("max", "min", "mod", "atan2", "hypot", "rem", "power")
OF_VECTOR = ("sum", "prod", "max", "min", "norm", "mean", "numel", "length", "any", "all")
OF_MATRIX = ("det", "trace", "norm", "numel", "rank")
ENDS = ("1", "2", "3", "end", "i", "end-1", "mod(k, 3) + 1")


class Writer:
    """Writes one program."""

    def __init__(self, rng):
        self._rng, self._depth = rng, 0

    def pick(self, options):
        return options[int(self._rng.integers(len(options)))]

    def chance(self, share):
        return self._rng.random() < share

    def number(self):
        return self.pick(("0", "1", "2", "3", "0.5", "-1", "pi", "1e3", "2.5", "true", "end_"))

    def scalar(self, deep=0):
        roll = int(self._rng.integers(14 if deep < 3 else 3))
        if roll < 2:
            return self.pick(SCALARS)
        if roll == 2:
            return self.number().replace("end_", "7")
        if roll < 7:
            sign = self.pick(("+", "-", "*", "/", "^", ".*", "<", ">=", "==", "~=", "&", "|"))
            return f"({self.scalar(deep + 1)} {sign} {self.scalar(deep + 1)})"
        if roll == 7:
            return f"{self.pick(OF_ONE)}({self.scalar(deep + 1)})"
        if roll == 8:
            return f"{self.pick(OF_TWO)}({self.scalar(deep + 1)}, {self.scalar(deep + 1)})"
        if roll == 9:
            return f"{self.pick(OF_VECTOR)}({self.vector(deep + 1)})"
        if roll == 10:
            return f"{self.pick(VECTORS)}({self.index()})"
        if roll == 11:
            return f"{self.pick(MATRICES)}({self.index()}, {self.index()})"
        if roll == 12:
            return self.pick(
                (
                    f"dot({self.vector(deep + 1)}, {self.vector(deep + 1)})",
                    f"{self.pick(OF_MATRIX)}({self.matrix(deep + 1)})",
                    f"g({self.scalar(deep + 1)}, {self.vector(deep + 1)})",
                    f"-{self.scalar(deep + 1)}",
                    f"~({self.scalar(deep + 1)})",
                    "s.p",
                    "c{2}",
                    "numel(c)",
                    "i",
                    "isempty(v)",
                    f"({self.scalar(deep + 1)} && {self.scalar(deep + 1)})",
                    f"({self.scalar(deep + 1)} || {self.scalar(deep + 1)})",
                )
            )
        return f"({self.scalar(deep + 1)})"

    def index(self):
        return self.pick(ENDS)

    def vector(self, deep=0):
        roll = int(self._rng.integers(12 if deep < 3 else 2))
        if roll < 2:
            return self.pick(VECTORS)
        if roll < 5:
            sign = self.pick(("+", "-", ".*", "./", ".^"))
            return f"({self.vector(deep + 1)} {sign} {self.vector(deep + 1)})"
        return self.pick(
            (
                f"({self.scalar(deep + 1)} * {self.vector(deep + 1)})",
                f"({self.matrix(deep + 1)} * {self.vector(deep + 1)})",
                f"[{self.scalar(deep + 1)}; {self.scalar(deep + 1)}; {self.scalar(deep + 1)}]",
                f"{self.pick(OF_ONE)}({self.vector(deep + 1)})",
                f"{self.pick(MATRICES)}(:, {self.index()})",
                f"{self.pick(MATRICES)}({self.index()}, :)'",
                f"cross({self.vector(deep + 1)}, {self.vector(deep + 1)})",
                f"zeros(3, 1) + {self.scalar(deep + 1)}",
                "s.q",
                "c{1}",
                f"({self.vector(deep + 1)} > {self.scalar(deep + 1)})",
                "v([3 1 2])",
                f"{self.pick(VECTORS)}(v > {self.scalar(deep + 1)})" if self.chance(0.1) else "w",
                f"({self.matrix(deep + 1)} \\ {self.vector(deep + 1)})",
                "(1:3)'",
                "u3(1)*v",
                f"h({self.vector(deep + 1)})",
                f"cumsum({self.vector(deep + 1)})",
                f"sort({self.vector(deep + 1)})",
            )
        )

    def matrix(self, deep=0):
        roll = int(self._rng.integers(10 if deep < 3 else 2))
        if roll < 2:
            return self.pick(MATRICES)
        if roll < 5:
            sign = self.pick(("+", "-", ".*", "*"))
            return f"({self.matrix(deep + 1)} {sign} {self.matrix(deep + 1)})"
        return self.pick(
            (
                f"({self.scalar(deep + 1)} * {self.matrix(deep + 1)})",
                "eye(3)",
                f"{self.matrix(deep + 1)}'",
                f"inv({self.matrix(deep + 1)} + 3*eye(3))",
                f"[{', '.join(self.vector(deep + 1) for _ in range(3))}]",
                f"[{'; '.join(self.vector(deep + 1) + chr(39) for _ in range(3))}]",
                f"diag({self.vector(deep + 1)})",
                f"({self.vector(deep + 1)} * {self.vector(deep + 1)}')",
                f"reshape({self.matrix(deep + 1)}, 3, 3)",
                f"expm({self.matrix(deep + 1)} / 10)",
            )
        )

    def block(self):
        self._depth += 1
        lines = [self.statement() for _ in range(1 + int(self._rng.integers(3)))]
        self._depth -= 1
        return "\n".join(lines)

    def statement(self):
        roll = int(self._rng.integers(22 if self._depth < 3 else 13))
        if roll < 4:
            return f"{self.pick(SCALARS)} = {self.scalar()};"
        if roll < 7:
            return f"{self.pick(VECTORS)} = {self.vector()};"
        if roll < 9:
            return f"{self.pick(MATRICES)} = {self.matrix()};"
        if roll == 9:
            return f"{self.pick(VECTORS)}({self.index()}) = {self.scalar()};"
        if roll == 10:
            return f"{self.pick(MATRICES)}({self.index()}, {self.index()}) = {self.scalar()};"
        if roll == 11:
            return self.pick(
                (
                    f"M(:, {self.index()}) = {self.vector()};",
                    f"N({self.index()}, :) = {self.vector()}';",
                    f"s.p = {self.scalar()};",
                    f"s.q = {self.vector()};",
                    f"s.q({self.index()}) = {self.scalar()};",
                    f"s.r.x = {self.vector()};",
                    f"c{{{self.pick(('1', '2', 'end+1', 'i'))}}} = {self.scalar()};",
                    f"[a, b] = max({self.vector()});",
                    f"[v, b] = h({self.vector()});",
                    "[a, b] = size(M);",
                    f"v(end+1) = {self.scalar()};" if self.chance(0.2) else "k = k + 2;",
                    "v = v(1:3);",
                    "v(2) = [];" if self.chance(0.2) else "k = k + 3;",
                    f"u{self.pick('123')}(end+1) = {self.scalar()};",
                    f"u{self.pick('123')}(i) = {self.scalar()};",
                    f"a = sum(u{self.pick('123')});",
                    f"n = n + {self.scalar()};",
                    "disp(v)",
                    f"f = @(x) x + {self.scalar()}; a = f({self.scalar()});",
                    "k = k + 1;",
                    "w = w(:);",
                    f"w = repmat({self.scalar()}, 3, 1);",
                    "v = v(:); w = w(:);",
                    "M = M(1:3, 1:3); N = N(1:3, 1:3);",
                )
            )
        if roll == 12:
            return self.pick(("v = [v(1); v(2); v(3)];", "w = [1; 2; 3];", "M = eye(3);"))
        if roll < 16:
            middle = f"\nelseif {self.scalar()}\n{self.block()}" if self.chance(0.4) else ""
            other = f"\nelse\n{self.block()}" if self.chance(0.5) else ""
            return f"if {self.scalar()}\n{self.block()}{middle}{other}\nend"
        if roll < 19:
            over = self.pick(("1:3", "1:n", "3:-1:1", "v'", "1:2", "1:3:4", "1:3", "[1 2 3]"))
            return f"for i = {over}\n{self.block()}{self.jump()}\nend\ni = 1;"
        if roll == 19:
            j = f"j{self._depth}"
            start = f"{j} = 0;\nwhile {j} < {self.pick(('3', '5', 'a'))}\n{j} = {j} + 1;\n"
            return f"{start}if {j} > 6, break; end\n{self.block()}{self.jump()}\nend"
        if roll == 20:
            cases = "\n".join(
                f"case {self.pick(('1', '{1, 2}', '3', 'a'))}\n{self.block()}" for _ in range(2)
            )
            return f"switch {self.scalar()}\n{cases}\notherwise\n{self.block()}\nend"
        return f"if {self.scalar()}, return; end"

    def jump(self):
        if self.chance(0.3):
            return f"\nif {self.scalar()}, {self.pick(('break', 'continue'))}; end"
        return ""

    def program(self):
        """A function of a number, a vector and a matrix, with two others that it calls."""
        body = "\n".join(self.statement() for _ in range(3 + int(self._rng.integers(6))))
        return (
            "function [x, y, z, k] = f(a, v, M)\n"
            "persistent k0\nif isempty(k0), k0 = 0; end\n"
            "b = 2; n = 3; w = [1; 2; 3]; N = [1 2 3; 4 5 6; 7 8 10]; i = 1; k = k0;\n"
            "s.p = 1; s.q = v; c = {v, 4}; u1 = []; u2 = 1; u3 = [1; 2];\nx = a; y = v; z = M;\n"
            f"{body}\n"
            "x = a + b; y = v; z = M*N; k0 = k;\nend\n"
            "function y = g(a, v)\npersistent m\n"
            f"if isempty(m), m = {self.pick(('1', '0', 'pi'))}+v; end\n"
            "m = m/2 + a; y = m(1);\nend\n"
            "function [y, n] = h(v)\ny = v; n = 0; if nargout > 1, n = numel(v); end\n"
            "for q = 1:numel(v), y(q) = v(q) + q; end\nend\n"
        )
