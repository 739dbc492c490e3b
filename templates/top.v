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
<%- for instance in instances %>

    ${ instance.module }$<% if !instance.parameters.is_empty() %> #(
<%- for line in instance.parameters %>
        ${ line }$
<%- endfor %>
    )<% endif %> ${ instance.name }$ (
<%- for line in instance.connections %>
        ${ line }$
<%- endfor %>
    );
<%- endfor %>
endmodule

`default_nettype wire
