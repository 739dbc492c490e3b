<%- for line in header %>${ line }$
<% endfor %>
`default_nettype none

module ${ name }$<% if !parameters.is_empty() %> #(
<%- for line in parameters %>
    ${ line }$
<%- endfor %>
)<% endif %> (
<%- for line in ports %>
${ line }$
<%- endfor %>
);
<%- for section in declarations %>

    // ${ section.title }$
<%- for line in section.lines %>
${ line }$
<%- endfor %>
<%- endfor %>
<%- for spaced in items %>
<%- if spaced.gap %>
<% endif %>
<%- match spaced.item %>
<%- when Item::Assign with (lines) %>
<%- for line in lines %>
${ line }$
<%- endfor %>
<%- when Item::Case with { comment, declaration, select, arms, default } %>
<%- for line in comment %>
${ line }$
<%- endfor %>
<%- for line in declaration %>
${ line }$
<%- endfor %>
    always @* begin
        case (${ select }$)
<%- for line in arms %>
${ line }$
<%- endfor %>
<%- for line in default %>
${ line }$
<%- endfor %>
        endcase
    end
<%- when Item::Rom with (rom) %>
<%- for line in rom.comment %>
${ line }$
<%- endfor %>
    reg ${ rom.range }$ ${ rom.memory }$ [0:${ rom.last }$];
    initial $readmem${ rom.radix }$(${ rom.parameter }$, ${ rom.memory }$);
<%- for line in rom.read %>
${ line }$
<%- endfor %>
<%- endmatch %>
<%- endfor %>
<%- for group in groups %>

    always @(posedge clk) begin
<%- for line in group %>
${ line }$
<%- endfor %>
    end
<%- endfor %>
<%- if !unused.is_empty() %>

    // Bits that nothing needs, among them those that narrowing drops.
<%- for line in unused %>
${ line }$
<%- endfor %>
<%- endif %>
<%- if !formal.is_empty() %>

`ifdef FORMAL
<%- for line in formal %>
${ line }$
<%- endfor %>
`endif
<%- endif %>
endmodule

`default_nettype wire
