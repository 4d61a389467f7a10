"""What a notebook shows: nothing that is written in a file becomes markup."""

import base64

from swingdown.markup import page, table


class Picture:
    def savefig(self, file, **options):
        assert options == {"format": "png", "dpi": 110}
        file.write(b"picture")


def test_a_table_has_a_head_where_it_is_given_and_words_to_the_left():
    made = table(["name", "T < 1"], [["a & b", 1.5], ["c", "<i>"]])
    assert made == (
        "<table><tr><th>name</th><th>T &lt; 1</th></tr>"
        "<tr><td style='text-align:left'>a &amp; b</td><td>1.5</td></tr>"
        "<tr><td style='text-align:left'>c</td><td>&lt;i&gt;</td></tr></table>"
    )
    assert table([], [["a"]]) == "<table><tr><td style='text-align:left'>a</td></tr></table>"


def test_a_page_has_its_lead_its_lines_its_body_and_its_picture():
    body = table([], [])
    assert page([], body) == body == "<table></table>"
    made = page(["a < b", "c"], body, Picture(), lead="T & Q")
    image = base64.b64encode(b"picture").decode()
    assert made == (
        f"<p><b>T &amp; Q</b></p><p>a &lt; b</p><p>c</p>{body}<img alt='the swings' src='data:image/png;base64,{image}'>"
    )
