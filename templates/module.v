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
<%- if !initial.is_empty() %>

    initial begin
<%- for line in initial %>
        ${ line }$
<%- endfor %>
    end
<%- endif %>
<%- include "items.v" %>
<%- include "groups.v" %>
<%- if !unused.is_empty() %>

    // Unused bits, among them those that narrowing drops.
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
