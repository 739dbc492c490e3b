                if (${ output.name }$ !== ${ output.select }$) begin
                    ${ names.errors }$ = ${ names.errors }$ + 1;
                    if (${ names.errors }$ <= REPORTED) begin
                        $write("clock %0d<% if address.is_some() %>, <% endif %>", ${ names.clock }$);
<%- if address.is_some() %>
                        ${ names.write_microinstruction }$;
<%- endif %>
                        $display(": ${ output.name }$ is %h, expected %h", ${ output.name }$, ${ output.select }$);
                    end
                end
