#pragma once
// One table of a TOML file: typed values within bounds, every mistake with its line, and no key
// that nobody asked for.
#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "examples/gateway/toml_parser.hpp"

namespace fairlead::gateway {

using Errors = std::vector<std::string>;

/// One table of the file: gives typed values within bounds, and names what nobody asked for.
class Section {
  public:
    Section(const toml::table& table, std::string name, const std::string& path, Errors& errors)
        : table_{table}, name_{std::move(name)}, path_{path}, errors_{errors} {}

    template <class T>
    void value(const char* key, T& out, const char* expected) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        if (const auto got = node->value_exact<T>()) {
            out = *got;
        } else {
            fail(node->source(), key, expected);
        }
    }
    /// Text without control characters, which neither a path nor a log line can hold.
    void text(const char* key, std::string& out) {
        std::string got = out;
        value(key, got, "must be text in quotes");
        const bool plain = std::all_of(got.begin(), got.end(), [](char c) {
            return static_cast<unsigned char>(c) >= 0x20 && c != 0x7F;
        });
        if (plain)
            out = got;
        else
            fail(find(key)->source(), key, "must not contain control characters");
    }
    void truth(const char* key, bool& out) { value(key, out, "must be true or false"); }
    template <class Int>
    void integer(const char* key, Int& out, std::int64_t min, std::int64_t max) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        const auto got = node->value_exact<std::int64_t>();
        if (got && *got >= min && *got <= max) {
            out = static_cast<Int>(*got);
        } else {
            fail(node->source(), key,
                 "must be a whole number from " + std::to_string(min) + " to " +
                     std::to_string(max));
        }
    }
    void real(const char* key, double& out, double min, double max) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        const auto got = node->value<double>();
        if (got && *got >= min && *got <= max) {
            out = *got;
        } else {
            fail(node->source(), key,
                 "must be a number from " + short_number(min) + " to " + short_number(max));
        }
    }
    /// Seconds in the file, nanoseconds in the program.
    void seconds(const char* key, std::int64_t& out, double min, double max) {
        double s = static_cast<double>(out) * 1e-9;
        real(key, s, min, max);
        out = static_cast<std::int64_t>(s * 1e9);
    }
    template <class T, class Parse>
    void list(const char* key, std::vector<T>& out, Parse parse, const char* expected) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        const toml::array* items = node->as_array();
        if (items == nullptr) return fail(node->source(), key, "must be a list in brackets");
        out.clear();
        for (const toml::node& item : *items) {
            const auto word = item.value_exact<std::string>();
            const auto parsed = word ? parse(*word) : std::nullopt;
            if (parsed) {
                out.push_back(*parsed);
            } else {
                fail(item.source(), key, expected);
            }
        }
    }
    /// As many finite numbers as the array has places, each at most `max` from zero.
    template <std::size_t N>
    void numbers(const char* key, std::array<float, N>& out, double max) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        const toml::array* items = node->as_array();
        bool good = items != nullptr && items->size() == N;
        for (std::size_t i = 0; good && i < N; ++i) {
            const auto got = items->get(i)->value<double>();
            good = got && *got >= -max && *got <= max;
            if (good) out[i] = static_cast<float>(*got);
        }
        if (!good) {
            fail(node->source(), key,
                 "must be a list of " + std::to_string(N) + " numbers from " + short_number(-max) +
                     " to " + short_number(max));
        }
    }
    const toml::node* find(const char* key) {
        known_.insert(key);
        return table_.get(key);
    }
    bool has(const char* key) const { return table_.contains(key); }
    void require(const char* key) {
        if (!has(key)) fail(table_.source(), key, "is missing");
    }
    void fail(const toml::source_region& at, const std::string& key, const std::string& what) {
        errors_.push_back(path_ + ":" + std::to_string(at.begin.line) + ": " + name_ + key + " " +
                          what);
    }
    Errors& errors() { return errors_; }
    const toml::source_region& source() const { return table_.source(); }
    Section inner(const toml::table& table, const std::string& name) const {
        return {table, name_ + name, path_, errors_};
    }

    /// Call last: a misspelt key must not be silently ignored.
    void finish() {
        for (const auto& [key, node] : table_) {
            if (known_.count(std::string{key.str()}) == 0) {
                fail(key.source(), std::string{key.str()}, "is not known here");
            }
        }
    }

  private:
    static std::string short_number(double v) {
        std::string s = std::to_string(v);
        s.erase(s.find_last_not_of('0') + 1);
        if (s.back() == '.') s.pop_back();
        return s;
    }

    const toml::table& table_;
    std::string name_;
    const std::string& path_;
    Errors& errors_;
    std::set<std::string> known_;
};

/// Parses `text` and hands its root table to use(). Whatever is wrong with it becomes one error.
template <class Use>
void parse_toml(const std::string& text, const std::string& path, Errors& errors, Use use) {
    if (const auto wrong = screen_toml(text)) {
        errors.push_back(path + ":" + *wrong);
        return;
    }
    try {
        const toml::table root = toml::parse(text, path);
        use(root);
    } catch (const toml::parse_error& error) {
        errors.push_back(path + ":" + std::to_string(error.source().begin.line) + ": " +
                         std::string{error.description()});
    } catch (const TomlFault& fault) {
        errors.push_back(path + ": the text is not TOML (" + fault.what() + ")");
    }
}

}  // namespace fairlead::gateway
