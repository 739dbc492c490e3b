<%- for line in wires %>${ line }$
<% endfor %>
${ name }$ u_${ name }$ (
<%- for line in connections %>
    ${ line }$
<%- endfor %>
);
